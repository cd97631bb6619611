"""Seeds side by side: spreads worked by hand, and runs that cannot be compared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analysis.reports import read_report
from analysis.seeds import FEWEST_FOR_INTERVALS, main, target_rows
from camp.common.paths import policies_root
from camp.evaluation.report import Finding, Report, SuiteStamp, write_report
from camp.evaluation.values import fraction
from tests.evaluation.reports import gait_summary, policy_summary
from tests.evaluation.reports import report as empty


def report(seed: int, right: int, error: float | None, **changes) -> Report:
    """80 trots, of which some are right."""
    skills = {"trot": gait_summary(fraction(np.arange(80) < right), 80)}
    verdict = [
        Finding("gait accuracy", 0.95, True, right / 80, 0.9, 1.0, 80, "shown" if right == 80 else "not shown"),
        Finding("velocity error, m/s", 0.15, False, error, None, None, 80, "missed"),
    ]
    values = {"seed": seed, "policies": {"trained": policy_summary(skills)}, "verdict": verdict, "skills": ["trot"]}
    return empty(**(values | changes))


def write(folder: Path, content: Report) -> str:
    folder.mkdir()
    write_report(folder / "eval.json", content)
    (folder / "eval.npz").write_bytes(b"")
    return str(folder)


def test_three_seeds_are_shown_by_least_median_and_greatest(tmp_path, capsys):
    found = [report(1, 76, 0.061), report(0, 80, 0.05), report(2, 72, 0.09)]
    folders = [write(tmp_path / str(one.seed), one) for one in found]
    assert main(folders) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == "suite v1 (a), seed of the suite 0, per training seed 80 walks"
    row = "| gait accuracy | >= 0.95 | 1.000 | 0.950 | 0.900 | 0.900 | 0.950 | 1.000 | 1 of 3 |"
    assert row in printed
    assert "| velocity error, m/s | <= 0.15 | 0.050 | 0.061 | 0.090 | 0.050 | 0.061 | 0.090 | 0 of 3 |" in printed
    trot = next(line for line in printed if line.startswith("| trot |"))
    assert trot.startswith("| trot | 100 % [95, 100] of 80, 2.04 Hz | 95 % [88, 98] of 80, 2.04 Hz |")
    assert printed[-1] == f"read from {folders[1]}/eval.json, {folders[0]}/eval.json, {folders[2]}/eval.json"


def test_five_seeds_have_intervals(tmp_path, capsys):
    right = (80, 78, 76, 80, 80)
    assert len(right) == FEWEST_FOR_INTERVALS
    assert main([write(tmp_path / str(k), report(k, n, 0.05)) for k, n in enumerate(right)]) == 0
    printed = capsys.readouterr().out
    # Interquartile mean of .95, .975, 1, 1, 1: one is left out at each end.
    assert "mean of seeds, 95 %" in printed and "| 0.992 [0.9" in printed
    assert "gait accuracy over skills and seeds, interquartile mean: 0.992 [0.9" in printed and "least" not in printed


def test_a_seed_without_a_figure_has_no_spread(tmp_path, capsys):
    rows = target_rows([report(0, 80, None), report(1, 80, 0.1)])
    assert rows[1].known == [0.1] and rows[0].shown == 2
    assert main([write(tmp_path / "a", report(0, 80, None)), write(tmp_path / "b", report(1, 80, 0.1))]) == 0
    assert "| velocity error, m/s | <= 0.15 | - | 0.100 | - | - | - | 0 of 2 |" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"variant": "no_skill_obs"}, "differ in variant (camp, no_skill_obs)"),
        ({"suite": SuiteStamp("short", "z", "b", "c", 0)}, "differ in suite (v1 a, short z)"),
        ({"suite": SuiteStamp("v1", "a", "z", "c", 0)}, "differ in gait criteria (b, z)"),
        ({"suite": SuiteStamp("v1", "a", "b", "z", 0)}, "differ in robot model (c, z)"),
        ({"iteration": 200}, "differ in iteration (400, 200)"),
        ({"skills": ["pace"]}, "differ in skills (['trot'], ['pace'])"),
        ({"parts": ["gait"]}, "differ in parts"),
        ({"verdict": []}, "judged by different targets"),
        ({"seed": 0}, "seeds 0, 0"),
    ],
)
def test_runs_that_cannot_be_compared_are_refused(changes, words, tmp_path, capsys):
    other = replace(report(1, 80, 0.1), **changes)
    assert main([write(tmp_path / "a", report(0, 80, 0.1)), write(tmp_path / "b", other)]) == 2
    assert words in capsys.readouterr().err


def test_a_run_without_an_evaluation_is_named_with_the_remedy(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert f"camp.evaluate run={tmp_path}" in capsys.readouterr().err


@pytest.mark.parametrize("content", ["{}", '{"run": "a", "verdict": 3}', "{", '{"format": 1}'])
def test_a_report_of_an_older_judge_or_a_malformed_one_is_one_line(content, tmp_path, capsys):
    (tmp_path / "eval.json").write_text(content)
    assert main([str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert f"{tmp_path}/eval.json" in error and "camp.evaluate" in error and error.count("\n") == 1


def test_shipped_evaluations_are_read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # without the user's own evaluations, which would be read instead
    for run in policies_root().iterdir():
        found = read_report(run)
        assert found.suite.name == "v1" and found.table_i is not None and found.verdict


def test_without_the_walks_there_are_no_gaits(tmp_path, capsys):
    content = report(0, 80, 0.1, parts=["switching"], policies={})
    assert main([write(tmp_path / "a", content)]) == 0
    printed = capsys.readouterr().out
    assert "| gait accuracy |" in printed and "stride" not in printed


def test_without_arguments_the_usage_is_an_error(capsys):
    assert main([]) == 2
    output = capsys.readouterr()
    assert output.out == "" and "python -m analysis.seeds <run folder>" in output.err and output.err.count("\n") == 1
