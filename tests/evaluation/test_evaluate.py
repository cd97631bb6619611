"""The whole evaluation on a tiny run: what it writes, what it logs, how it refuses."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from camp.cli.hydra_main import run_hydra
from camp.evaluate import evaluate
from camp.evaluation import films, record
from camp.evaluation.report import Report, read_report
from camp.robots.go2 import GO2
from tests.small_run import small_run

SHORT = [
    "suite=short",
    "duration_s=2.5",
    "discard_s=0.5",
    "threads=1",
    "walks.per_skill=2",
    "walks.baseline_per_skill=1",
    "table_i.per_skill=2",
    "robustness.per_skill=1",
    "commands=[[0.5,0,0]]",
    "switching.within_s=0.5",
    "switching.skill_s=1.5",
    "switching.skills_per_sequence=2",
    "video_skills=true",
    "video_s=0.2",
]
CONDITIONS = "robustness.conditions=[{name: nominal},{name: loaded,payload_mass_kg: 3},{name: late,delay_s: 0.02}]"


def judged(run: Path, *overrides: str) -> Report:
    assert run_hydra("evaluation/evaluate", evaluate, [f"run={run}", *SHORT, *overrides]) == 0
    return read_report(run / "eval.json", "")


class FakeRecord:
    """Stands in for a W&B run."""

    def __init__(self):
        self.logged: dict = {}
        self.summary: dict = {}
        self.finished = False

    def log(self, values: dict, step: int | None) -> None:
        self.logged, self.step = values, step

    def finish(self) -> None:
        self.finished = True


def test_evaluating_a_run_writes_its_report(tmp_path, capsys, monkeypatch):
    run, wandb_run = small_run(tmp_path / "run", ["motion.skills=[trot,bound]"]), FakeRecord()
    config = run / "config.yaml"
    config.write_text(config.read_text().replace("wandb_mode: disabled", "wandb_mode: offline"))
    monkeypatch.setattr(record, "start_wandb", lambda *_: wandb_run)
    parts = "parts=[gait,table_i,switching,tracking,quality,reference,robustness]"
    report = judged(run, parts, "baselines=true", CONDITIONS)

    assert set(report.policies) == {"trained", "untrained", "standing", "sine"}
    standing = report.policies["standing"].all
    assert standing.falls == 0 and standing.stepping == 0.0 and standing.rollouts == 2
    for name in ("untrained", "standing", "sine"):
        found = report.policies[name].all.gait_accuracy
        assert found is not None and found.value == 0.0
    assert list(report.robustness) == ["nominal", "loaded", "late"]
    assert report.switching is not None and report.switching.sequences == 2 and report.switching.all.switches == 2
    assert report.table_i is not None and report.table_i.walks.all.rollouts == 4
    assert sum(part.right.n for part in report.table_i.friction if part.right) == 4
    assert {finding.name for finding in report.verdict} >= {"gait accuracy", "gait accuracy, Table I"}
    assert report.suite.name == "custom" and report.policy is not None and report.iteration == 7
    with np.load(run / "eval.npz", allow_pickle=False) as saved:
        assert saved["contact"].shape == (2, 1, 125, 4)
        assert saved["skill_switch_contact"].shape == (150, 4)
        assert saved["walk_failed"].shape == (4, 7) and saved["table_i_friction"].shape == (4,)

    assert wandb_run.finished
    skills = wandb_run.logged["evaluation/skills"]
    assert [row[:2] for row in skills.data] == [["trot", 2], ["bound", 2]] and len(skills.columns) == len(
        skills.data[0]
    )
    assert wandb_run.summary["evaluation/policies/standing/all/stepping"] == 0.0
    output = capsys.readouterr()
    assert (
        "missed" in output.out
        and "one disturbance at a time" in output.out
        and "walking, control steps: 150 of 150" in output.out
    )
    if "no videos" in output.err:
        pytest.skip("no off-screen OpenGL here")
    videos = sorted(path.name for path in (run / "videos").glob("*.mp4"))
    assert videos == ["bound.mp4", "switching.mp4", "trot.mp4"]
    pictures = {f"evaluation/video/{p[:-4]}" for p in videos}
    assert wandb_run.logged.keys() == pictures | {"evaluation/skills"} and wandb_run.step == 8


def test_an_ablation_and_its_skills_of_one_frequency(tmp_path):
    more = ["+ablation=amp_baseline", "motion.labels=gait_frequency", "motion.skills=[trot,pronk]"]
    run = small_run(tmp_path / "run", more)
    report = judged(run, "parts=[gait]", "video=false")
    assert list(report.policies["trained"].skills) == ["trot_2hz", "trot_3hz", "pronk_2hz", "pronk_3hz"]
    assert report.switching is None and report.robustness == {} and report.tracking == {}


def test_the_same_policy_gets_the_same_report(tmp_path):
    run = small_run(tmp_path / "run", ["motion.skills=[trot,bound]"])
    first = judged(run, "parts=[gait,table_i]", "video=false")
    again = judged(run, "parts=[gait,table_i,robustness]", "video=false", "baselines=true", CONDITIONS)
    assert again.policies["trained"] == first.policies["trained"] and again.table_i == first.table_i


def test_places_that_cannot_be_written_are_told_before_work_starts(tmp_path, monkeypatch, capsys):
    def work(*_):
        raise AssertionError("work has started")

    run = small_run(tmp_path / "run")
    monkeypatch.setattr("camp.evaluate.Evaluator", work)
    (run / "videos").write_text("")
    assert run_hydra("evaluation/evaluate", evaluate, [f"run={run}"]) == 2
    error = capsys.readouterr().err
    assert str(run / "videos") in error and error.count("\n") == 1

    monkeypatch.setattr("camp.evaluate.results_folder", lambda _: tmp_path / "outputs" / "run")
    (tmp_path / "outputs").write_text("")
    assert run_hydra("evaluation/evaluate", evaluate, [f"run={run}", "video=false"]) == 2
    error = capsys.readouterr().err
    assert str(tmp_path / "outputs" / "run") in error and error.count("\n") == 1


def test_a_video_that_cannot_be_written_leaves_the_others(tmp_path, monkeypatch, capsys):
    def write(path, frames, _):
        if path.stem == "trot":
            raise OSError("No space left on device")
        path.write_bytes(b"mp4")

    seen = {"velocity": np.zeros((2, 4, 3)), "step_contact": np.zeros((2, 4, 4), bool), "qpos": np.zeros((2, 4, 19))}
    skill = np.array([[0] * 4, [1] * 4])
    recording = SimpleNamespace(period_s=0.02, skill=skill, command=np.zeros((2, 3)), **seen)
    judgement: Any = SimpleNamespace(grid=recording, switching=None)
    evaluation: Any = SimpleNamespace(
        video_skills=True, video_high=False, video_s=0.08, video_command=0, commands=[[0.5, 0, 0]]
    )
    monkeypatch.setattr(films, "RobotRenderer", lambda *_: SimpleNamespace(frame=None, close=lambda: None))
    monkeypatch.setattr(films, "write_video", write)
    assert films.film(GO2, judgement, ["trot", "pace"], evaluation, tmp_path) == {"pace": tmp_path / "pace.mp4"}
    assert capsys.readouterr().err == f"no video {tmp_path / 'trot.mp4'}: No space left on device\n"


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("parts=[gait,style,looks]", "choose from gait, table_i"),
        ("parts=[]", "parts = []"),
        ("duration_s=3", "leave 2 s or more of the 3.0 s"),
        ("switching.skill_s=1.5", "switching.skill_s = 1.5: choose 2 s or more"),
        ("switching.skills_per_sequence=1", "switching.skills_per_sequence = 1: choose a whole number from 2"),
        ("walks.per_skill=0", "walks.per_skill = 0"),
        ("commands=[[0.5,0]]", "give [vx, vy, yaw rate]"),
        ("robustness.conditions=[{name: ice,fricton: 0.1}]", "robustness.conditions[ice].fricton"),
        ("targets.gait_accuracy=95", "targets.gait_accuracy = 95.0"),
        ("suite=long", "suite"),
        (f"seed={2**64}", "seed = 18446744073709551616: choose a whole number from 0 to 18446744073709551615"),
        ("run=nowhere", "nowhere"),
    ],
)
def test_a_wrong_value_is_one_line(override, message, tmp_path, capsys):
    assert run_hydra("evaluation/evaluate", evaluate, [f"run={tmp_path / 'none'}", override]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1
