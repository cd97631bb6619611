"""Figures worked out by hand, a table of 80 columns, and the page that shows the shipped results."""

from __future__ import annotations

from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from camp.common.errors import CampError
from camp.common.paths import repository_root
from camp.gaits.schedule import GAIT_PHASES
from camp.transfer.results import judge, read_result, read_results, write_result
from camp.transfer.summary import TABLE_WIDTH, figures, frequency_ratios, markdown, skills_of, tables
from camp.transfer.walks import Walk
from tests.transfer.results import FAST, FELL, RIGHT, STAMP, result

SECONDS, PERIOD = 6.0, 0.02


def walked(gait: str, hertz: float, fell: bool = False) -> Walk:
    """A gait of duty .5 whose feet lift by 6 cm, at 0.5 m/s."""
    time = np.arange(round(SECONDS / 0.005))[:, None] * 0.005
    phase = np.mod(time * hertz - np.array(GAIT_PHASES[gait]), 1.0)
    height = np.where(phase < 0.5, 0.0, 0.06 * np.sin(2 * np.pi * (phase - 0.5)))[::4]
    return Walk(phase < 0.5, height, np.tile([0.5, 0.0, 0.0], (len(height), 1)), fell)


def test_a_walk_is_judged_by_the_judges_criteria():
    found = judge(walked("trot", 2.0), "trot_2hz", [0.6, 0.0, 0.0], PERIOD, 2.0)
    assert found.right and found.gait == "trot" and found.failed == [] and found.fell_after_s is None
    assert found.frequency_hz == pytest.approx(2.0, abs=0.02) and found.velocity == [0.5, 0.0, 0.0]
    assert judge(walked("trot", 3.0), "trot_2hz", [0.6, 0.0, 0.0], PERIOD, 2.0).failed == ["frequency"]
    wrong = judge(walked("pace", 2.0), "trot_2hz", [0.6, 0.0, 0.0], PERIOD, 2.0)
    assert wrong.gait == "pace" and not wrong.right and wrong.failed is not None and "gait" in wrong.failed


def test_a_fall_is_no_gait():
    found = judge(walked("trot", 2.0, fell=True), "trot_2hz", [0.6, 0.0, 0.0], PERIOD, 2.0)
    assert found.fell_after_s == SECONDS and found.gait is None and not found.right


def test_figures_by_hand():
    found = figures([RIGHT, FAST, FELL])
    assert found.right is not None and found.label is not None
    assert found.right.value == pytest.approx(1 / 3) and found.label.value == pytest.approx(2 / 3) and found.falls == 1
    assert found.frequency_ratio == pytest.approx((1.05 + 1.2) / 2)
    assert found.linear_error_m_s == pytest.approx(0.05) and found.yaw_rate_error_rad_s == pytest.approx(0.01)
    nothing = figures([FELL])
    assert nothing.frequency_ratio is None and nothing.linear_error_m_s is None and nothing.falls == 1
    assert frequency_ratios([RIGHT, FELL]) == pytest.approx([1.05])
    assert skills_of([result("dart", RIGHT, FAST, FELL)]) == ["trot_2hz", "pace_2hz"]


def printed(*results) -> list[str]:
    console = Console(width=TABLE_WIDTH, file=StringIO())
    console.print(tables(results))
    return console.file.getvalue().splitlines()  # pyright: ignore[reportAttributeAccessIssue]


def test_the_tables_are_80_columns_wide():
    lines = printed(*(result(name, *[RIGHT] * 140, FELL) for name in ("drake", "sapien", "mujoco", "dart")))
    assert max(map(len, lines)) <= 80 and not any("…" in line for line in lines)
    rows = [line.split()[1] for line in lines if line.startswith(" go2")]
    assert rows == ["mujoco", "sapien", "dart", "drake"]
    assert any("140/140" in line for line in lines)


def test_two_robots_and_policies_stand_side_by_side_in_80_columns():
    many = [
        result(engine, RIGHT, robot=robot, policy=policy)
        for robot in ("go2", "a1")
        for policy in ("go2_camp", "a1_camp")
        for engine in ("mujoco", "sapien", "dart", "drake")
    ]
    lines = printed(*many)
    assert max(map(len, lines)) <= 80 and not any("…" in line for line in lines)
    assert sum("1/1" in line for line in lines) == len([line for line in lines if "right walks by skill" in line]) > 1
    alone = printed(*(one for one in many if one.policy == "a1_camp"))
    assert not any("a1_camp" in line for line in alone) and any(line.split()[:1] == ["a1"] for line in alone)
    rows = markdown(many).splitlines()[2:]
    assert [row.split(" | ")[:2] for row in rows[::4]] == [
        ["| go2", "a1_camp"],
        ["| go2", "go2_camp"],
        ["| a1", "a1_camp"],
        ["| a1", "go2_camp"],
    ]


def test_results_of_another_suite_stand_apart():
    other = result("drake", FAST, suite=STAMP.__class__("full", "x", "b", "c", 0))
    lines = printed(result("dart", RIGHT), other)
    assert [line.split(" (")[0] for line in lines if line.startswith("engines")] == [
        "engines, suite short",
        "engines, suite full",
    ]
    assert any("frequency" in line for line in lines)


def test_a_file_holds_the_whole_result(tmp_path):
    write_result(tmp_path / "one.json", result("dart", RIGHT, FELL))
    assert read_results(tmp_path) == [result("dart", RIGHT, FELL)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "result .*none.json: No such file or directory; walk again"),
        ("{", "no result of camp.transfer .*; walk again, or remove it"),
        ('{"format": 2}', "no result of camp.transfer .*; walk again, or remove it"),
    ],
)
def test_a_file_that_is_no_result_is_one_line(tmp_path, text, message):
    path = tmp_path / "none.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(CampError, match=message):
        read_result(path)


def test_a_folder_without_results_is_one_line(tmp_path):
    with pytest.raises(CampError, match=r"holds no results; run `python -m camp.transfer <policy> engine=all` first"):
        read_results(tmp_path)


def test_the_page_shows_the_shipped_results():
    root = repository_root()
    assert root is not None
    results = read_results(root / "docs" / "transfer")
    assert {one.engine for one in results} == {"mujoco", "sapien", "dart", "drake"}
    assert markdown(results) in (root / "docs" / "transfer.md").read_text()
