"""Evaluation of known motion: the expert's own targets must score, standing must not."""

from __future__ import annotations

import json

import numpy as np
import pytest

from camp.cli import run_hydra
from camp.evaluate import evaluate
from camp.evaluation.report import arrays, summarize, summarize_switching
from camp.evaluation.rollout import Recording
from camp.motion.gaits import GAIT_PHASES
from camp.motion.skills import skill_set
from camp.train import train

GAITS = ("trot", "pace", "bound", "pronk")
SKILLS = skill_set(GAITS, "gait", ())
COMMANDS = [[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]]
STEPS = 500


def contacts(gait: str, frequency: float = 2.5) -> np.ndarray:
    phase = np.arange(STEPS)[:, None] * 0.02 * frequency - np.array(GAIT_PHASES[gait])
    return np.mod(phase, 1.0) < 0.5


def recording(shown: dict[str, str]) -> Recording:
    """Each skill shows the gait ``shown[skill]`` at exactly the commanded velocity; the switch shows all in turn."""
    rows = len(SKILLS) * len(COMMANDS) + 1
    skill = np.repeat(np.repeat(np.arange(4), len(COMMANDS))[:, None], STEPS, axis=1)
    switch = np.arange(STEPS) * 4 // STEPS
    contact = np.stack([contacts(shown[GAITS[k]]) for k in skill[:, 0]])
    in_turn = np.concatenate([contacts(name)[switch == k] for k, name in enumerate(GAITS)])
    command = np.repeat(np.array([*COMMANDS * 4, [0.5, 0, 0]])[:, None], STEPS, axis=1)
    joints = np.sin(np.arange(STEPS) * 0.1)[None, :, None].repeat(rows, 0).repeat(12, 2)
    return Recording(
        period_s=0.02,
        skill=np.concatenate([skill, switch[None]]),
        command=command,
        velocity=command + np.array([0.1, 0.0, 0.0]),
        contact=np.concatenate([contact, in_turn[None]]),
        joint_target=joints,
        joint_position=joints,
        qpos=np.zeros((rows, STEPS, 19)),
        steps_upright=np.full(rows, STEPS),
    )


def test_right_gaits_score_fully():
    summary = summarize(recording({gait: gait for gait in GAITS}), SKILLS, 2.0)
    assert summary["all"]["gait_accuracy"] == 1.0 and summary["all"]["falls"] == 0
    assert summary["skills"]["bound"]["frequency_hz"] == pytest.approx(2.5, rel=0.03)
    assert summary["all"]["linear_error_m_s"] == pytest.approx(0.1)
    assert summary["all"]["linear_error_fast_m_s"] == pytest.approx(0.1)
    assert summary["all"]["joint_tracking"]["thigh"] == 1.0
    np.testing.assert_allclose(summary["skills"]["trot"]["phase"], [0.0, 0.5, 0.5, 0.0], atol=0.01)


def test_wrong_gaits_stand_in_the_confusion_matrix():
    summary = summarize(recording({"trot": "trot", "pace": "trot", "bound": "bound", "pronk": "trot"}), SKILLS, 2.0)
    assert summary["skills"]["pace"]["gait_accuracy"] == 0.0
    assert summary["all"]["gait_accuracy"] == 0.5
    assert summary["confusion"]["pronk"]["trot"] == 2 and summary["confusion"]["trot"]["trot"] == 2


def test_skills_of_one_frequency_ask_for_that_frequency():
    skills = skill_set(GAITS, "gait_frequency", (2.0,))  # what is shown steps at 2.5 Hz
    summary = summarize(recording({gait: gait for gait in GAITS}), skills, 2.0)
    assert summary["all"]["gait_accuracy"] == 0.0 and summary["confusion"]["trot_2hz"]["none"] == 2
    near = skill_set(GAITS, "gait_frequency", (2.4,))
    assert summarize(recording({gait: gait for gait in GAITS}), near, 2.0)["all"]["gait_accuracy"] == 1.0


def test_a_fall_is_no_gait():
    fell = recording({gait: gait for gait in GAITS})
    fell.steps_upright[0] = 300
    summary = summarize(fell, SKILLS, 2.0)
    assert summary["skills"]["trot"]["gait_accuracy"] == 0.5 and summary["skills"]["trot"]["falls"] == 1
    assert summary["confusion"]["trot"]["fell"] == 1


def test_switching_sequence_finds_every_gait():
    result = summarize_switching(recording({gait: gait for gait in GAITS}), SKILLS)
    assert not result["fell"]
    assert all(seconds is not None and seconds <= 1.0 for seconds in result["seconds_to_gait"].values())


def test_arrays_have_the_shapes_the_analysis_reads():
    saved = arrays(recording({gait: gait for gait in GAITS}), SKILLS, COMMANDS)
    assert saved["contact"].shape == (4, 2, STEPS, 4) and saved["contact"][2, 0].sum() == contacts("bound").sum()
    assert saved["skill_switch_contact"].shape == (STEPS, 4)


def test_evaluating_a_run_writes_its_report(tmp_path, capsys):
    tiny = ["run=smoke", "sim.num_envs=8", "sim.threads=1", "run.iterations=1", "motion.num_preloaded=400"]
    assert run_hydra("train", train, [*tiny, "logger.wandb_mode=disabled", f"output_dir={tmp_path}"]) == 0
    run = (tmp_path / "latest").resolve()
    short = ["duration_s=2.5", "discard_s=0.5", "commands=[[0.5,0,0]]", "video_command=0", "video_s=0.2"]
    assert run_hydra("evaluation/evaluate", evaluate, [f"run={run}", *short]) == 0
    report = json.loads((run / "eval.json").read_text())
    assert set(report["policies"]) == {"trained", "untrained", "standing"}
    standing = report["policies"]["standing"]["all"]
    assert standing["falls"] == 0 and standing["stepping"] == 0.0
    assert standing["linear_error_fast_m_s"] == pytest.approx(0.5, abs=0.1)
    with np.load(run / "eval.npz", allow_pickle=False) as saved:
        assert saved["contact"].shape == (4, 1, 125, 4)
    if "no videos" in capsys.readouterr().err:
        pytest.skip("no off-screen OpenGL here")
    videos = sorted(path.name for path in (run / "videos").glob("*.mp4"))
    assert videos == ["bound.mp4", "pace.mp4", "pronk.mp4", "switching.mp4", "trot.mp4"]


def test_evaluating_nothing_is_one_line(tmp_path, capsys):
    assert run_hydra("evaluation/evaluate", evaluate, [f"run={tmp_path / 'none'}"]) == 2
    assert "none" in capsys.readouterr().err
