"""Table IV of a made-up study."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import pytest

from analysis.tables import Table, ablation_table, difference_table, narrow_table, seed_table
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


def test_differences_are_of_the_same_seed():
    table = difference_table(study_result())
    (row,) = table.rows
    found = dict(zip(table.heading, row, strict=True))
    assert found["difference to full"] == "style not conditional" and found["falls per walk"] == "0.00 [0.00, 0.00]"
    assert found["information (bits)"] == "-2.00 [-2.00, -2.00]"
    assert found["switches in time"].startswith("-0.79 [")  # .1, .11, .12 less .9
    alone = replace(study_result(), arms=["full"])
    assert difference_table(alone).rows == []


def test_every_run_has_a_row_of_numbers():
    table = seed_table(study_result())
    rows = list(csv.DictReader(io.StringIO(table.as_csv())))
    assert [(row["arm"], row["seed"]) for row in rows[:3]] == [("full", "0"), ("no_conditioning", "0"), ("full", "1")]
    assert [float(row["velocity error (m/s)"]) for row in rows[::2]] == [0.05, 0.06, 0.07]


def test_the_printed_table_is_narrow():
    table = narrow_table(study_result())
    assert table.rows[0][:3] == ["full", "Yes (Yes)", "Yes (Yes)"] and table.rows[1][1:3] == ["No (No)", "No (No)"]
    assert len(table.heading) == 7


def test_three_formats_hold_the_same_cells(table):
    assert list(csv.reader(io.StringIO(table.as_csv()))) == [table.heading, *table.rows]
    markdown = table.as_markdown().splitlines()
    assert len(markdown) == 4 and markdown[2].startswith("| full | 3 | Yes |")
    latex = table.as_latex()
    assert latex.count(r"\\") == 3 and r"\toprule" in latex


def test_latex_escapes():
    assert r"50\% \& no\_gait" in Table(["a"], [["50% & no_gait"]]).as_latex()
