"""The printed report: readable at 80 columns, failures and the worst rows first."""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from rich.table import Table

from camp.common.paths import policies_root
from camp.evaluation.cells import fitted, table, worst_first
from camp.evaluation.report import Report, read_report
from camp.evaluation.tables import printed
from camp.judge import judge

SHIPPED = policies_root() / "go2_camp" / "eval.json"


@pytest.fixture(scope="module")
def report() -> Report:
    """The shipped policy's: all parts."""
    return read_report(SHIPPED, "")


def text(part: object, width: int) -> str:
    out = io.StringIO()
    Console(file=out, width=width).print(part)
    return out.getvalue()


@pytest.mark.parametrize("everything", [False, True])
@pytest.mark.parametrize("width", [80, 100])
def test_nothing_is_cut(report, width, everything):
    shown = text(printed(report, width, everything), width)
    assert "…" not in shown and "..." not in shown
    assert max(map(len, shown.splitlines())) <= width
    for skill in report.skills:
        assert f"{skill} " in shown  # whole, in one line


def test_failures_and_the_worst_come_first(report):
    lines = text(printed(report, 80, False), 80).splitlines()
    assert "verdict" in lines[0]
    verdicts = [word for line in lines for word in ("missed", "not shown", "shown") if f"  {word}  " in line]
    assert verdicts[0] == "missed" and verdicts[-1] == "shown"
    gaits = next(number for number, line in enumerate(lines) if "gaits, nominal" in line)
    skills = report.policies["trained"].skills
    shown = [skills[line.split()[1]].gait_accuracy.value for line in lines[gaits + 4 : gaits + 4 + len(skills)]]
    assert shown == sorted(shown) and shown[0] < shown[-1]


def test_all_tables_of_a_report_that_is_there(capsys):
    judge([f"report={SHIPPED}"])
    shown = capsys.readouterr().out
    assert "distance to the nearest expert clip" in shown and "by criterion" in shown and "…" not in shown


def test_a_wide_table_becomes_several_with_the_same_first_column():
    whole = table("wide", ("skill",), [f"figure {n}" for n in range(10)])
    whole.add_row("trot_2hz", *map(str, range(10)))
    parts = fitted(whole, 40)
    assert len(parts) == 5 and all(isinstance(part, Table) and part.columns[0].header == "skill" for part in parts)
    assert [column.header for part in parts for column in part.columns[1:]] == [f"figure {n}" for n in range(10)]


def test_what_has_no_value_comes_last():
    assert list(worst_first({"a": 0.5, "b": None, "c": 0.1}, lambda value: value)) == ["c", "a", "b"]
