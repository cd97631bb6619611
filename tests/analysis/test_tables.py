"""Table IV of a made-up study."""

from __future__ import annotations

import csv
import io

import pytest

from analysis.tables import Table, ablation_table
from tests.analysis.studies import study_result


@pytest.fixture(scope="module")
def table() -> Table:
    return ablation_table(study_result())


def cells(table: Table, row: int) -> dict[str, str]:
    return dict(zip(table.heading, table.rows[row], strict=True))


def test_yes_and_no_stand_beside_the_papers(table):
    full, other = table.rows
    assert full[:6] == ["full", "3", "Yes", "Yes", "Yes", "Yes"]
    assert other[:6] == ["style not conditional", "3", "No", "No", "No", "No"]


def test_figures_have_intervals_over_seeds(table):
    full, other = cells(table, 0), cells(table, 1)
    assert full["information (bits)"] == "2.00 [2.00, 2.00]" and other["gaits shown"] == "1.00 [1.00, 1.00]"
    assert full["velocity error (m/s)"].startswith("0.06 [0.05,")
    assert full["bits - full's"] == "-" and other["bits - full's"] == "-2.00 [-2.00, -2.00]"


def test_three_formats_hold_the_same_cells(table):
    assert list(csv.reader(io.StringIO(table.as_csv()))) == [table.heading, *table.rows]
    markdown = table.as_markdown().splitlines()
    assert len(markdown) == 4 and markdown[2].startswith("| full | 3 | Yes |")
    latex = table.as_latex()
    assert latex.count(r"\\") == 3 and r"\toprule" in latex


def test_latex_escapes():
    assert r"50\% \& no\_gait" in Table(["a"], [["50% & no_gait"]]).as_latex()
