"""Seeds side by side: worst figures and counts worked by hand, and runs that cannot be compared."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from analysis.reports import parse_report, read_report
from analysis.seeds import TargetRow, main, target_rows
from camp.common.paths import policies_root


def walking(*skills: str, accuracy: float = 1.0) -> dict:
    return {"trained": {"skills": {name: {"gait_accuracy": accuracy, "frequency_hz": 2.04} for name in skills}}}


def report(seed: int, accuracy: float, error: float | None, **changes) -> dict:
    return {
        "variant": "camp",
        "parts": ["gait"],
        "duration_s": 10.0,
        "discard_s": 2.0,
        "seed": seed,
        "iteration": 400,
        "policies": walking("trot_2hz", accuracy=accuracy),
        "performed": {"trot_2hz": {"forward_0.6": "trot_2hz"}},
        "verdict": [
            {"name": "gait accuracy", "target": 0.95, "reached": accuracy, "at_least": True},
            {"name": "velocity error, m/s", "target": 0.15, "reached": error, "at_least": False},
        ],
    } | changes


def write(folder: Path, content: dict) -> str:
    folder.mkdir()
    (folder / "eval.json").write_text(json.dumps(content))
    return str(folder)


def test_the_worst_seed_and_how_many_met_the_target():
    contents = [report(0, 1.0, 0.06), report(1, 0.9, 0.2), report(2, 0.96, 0.1)]
    accuracy, error = target_rows([parse_report(content) for content in contents])
    assert (accuracy.worst, accuracy.met) == (0.9, 2)
    assert (error.worst, error.met) == (0.2, 2)


def test_a_seed_without_a_figure_has_not_met_the_target():
    row = TargetRow("gait accuracy", 0.95, True, (1.0, None))
    assert row.worst is None and row.met == 1


def test_tables_in_order_of_the_seeds(tmp_path, capsys):
    folders = [
        write(tmp_path / "b", report(1, 0.9231, 0.061)),
        write(tmp_path / "a", report(0, 1.0, 0.05)),
    ]
    assert main(folders) == 0
    printed = capsys.readouterr().out.splitlines()
    assert "| gait accuracy | >= 0.95 | 1.000 | 0.923 | 0.923 | 1 of 2 |" in printed
    assert "| velocity error, m/s | <= 0.15 | 0.050 | 0.061 | 0.061 | 2 of 2 |" in printed
    assert "| trot_2hz | 100 %, 2.04 Hz | 92 %, 2.04 Hz |" in printed


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (report(1, 1.0, 0.1, variant="no_skill_obs"), "differ in variant (camp, no_skill_obs)"),
        (report(1, 1.0, 0.1, duration_s=6.0), "differ in duration_s (10.0, 6.0)"),
        (report(1, 1.0, 0.1, iteration=200), "differ in iteration (400, 200)"),
        (report(1, 1.0, 0.1, policies=walking("trot_2hz", "pace_2hz")), "skills (['trot_2hz'], ['trot_2hz', 'pace"),
        (report(1, 1.0, 0.1, policies=walking("pace_2hz")), "skills (['trot_2hz'], ['pace_2hz'])"),
        (report(1, 1.0, 0.1, performed={"trot_2hz": {"in_place": "trot_2hz"}}), "commands (['forward_0.6'], ['in_pla"),
        (report(1, 1.0, 0.1, verdict=[]), "judged by different targets"),
        (report(0, 1.0, 0.1), "seeds 0, 0"),
    ],
)
def test_runs_that_cannot_be_compared_are_refused(other, words, tmp_path, capsys):
    folders = [write(tmp_path / "a", report(0, 1.0, 0.1)), write(tmp_path / "b", other)]
    assert main(folders) == 2
    assert words in capsys.readouterr().err


def test_a_run_without_an_evaluation_is_named_with_the_remedy(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert f"camp.evaluate run={tmp_path}" in capsys.readouterr().err
    (tmp_path / "eval.json").write_text("{}")
    assert main([str(tmp_path)]) == 2
    assert "no evaluation's report" in capsys.readouterr().err


def test_an_evaluation_is_read_from_the_run_folder(tmp_path):
    folder = write(tmp_path / "a", report(3, 1.0, 0.1))
    assert read_report(Path(folder)).seed == 3


def test_shipped_evaluations_are_read():
    for run in policies_root().iterdir():
        found = read_report(run)
        assert found.gaits and found.commands and found.findings


def test_an_evaluation_without_the_grid_has_its_targets(tmp_path, capsys):
    content = report(0, 1.0, 0.1, parts=["switching"])
    del content["policies"], content["performed"]
    assert main([write(tmp_path / "a", content)]) == 0
    printed = capsys.readouterr().out
    assert "| gait accuracy |" in printed and "stride" not in printed


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"verdict": 3}, "int"),
        ({"verdict": [3]}, "int"),
        ({"verdict": [{"name": "falls"}]}, "no entry 'at_least'"),
        ({"verdict": [{"name": "falls", "target": "a", "reached": 1, "at_least": True}]}, "falls is 'a', no number"),
        ({"policies": 3}, "int"),
        ({"policies": {"trained": {"skills": ["trot"]}}}, "list"),
        ({"policies": {"trained": {"skills": {"trot": {"gait_accuracy": None, "frequency_hz": 1}}}}}, "gait_accuracy"),
        ({"performed": {"trot": 3}}, "int"),
        ({"seed": "zero"}, "seed is 'zero', no whole number"),
    ],
)
def test_a_malformed_report_is_one_line(changes, words, tmp_path, capsys):
    folder = write(tmp_path / "a", report(0, 1.0, 0.1) | changes)
    assert main([folder]) == 2
    error = capsys.readouterr().err
    assert words in error and f"{folder}/eval.json" in error and "camp.evaluate" in error and error.count("\n") == 1


def test_without_arguments_the_usage_is_an_error(capsys):
    assert main([]) == 2
    output = capsys.readouterr()
    assert output.out == "" and "python -m analysis.seeds <run folder>" in output.err and output.err.count("\n") == 1
