"""Figures of a run's configuration, roll-outs and evaluation, on small or shipped data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.contacts import touches_per_stance
from analysis.data_flow import compute_boxes, draw_data_flow
from analysis.evaluation_figures import confusion_panel, draw_confusion, draw_robustness
from analysis.joints import compute_joints, draw_joints, fit, nearest_clip
from analysis.load import AnalysisError
from analysis.seeds import accuracy
from analysis.sequence import one_skill_of_each_gait
from analysis.skill_cost import compute_cost, draw_cost
from camp.build import load_run
from camp.common.paths import policies_root, shipped_motions
from camp.config.compose import compose_config
from camp.evaluation.expert import recording_of
from camp.evaluation.report import read_report
from camp.metrics.reference import PHASES, mean_stride
from camp.motion.clips.store import load_clip
from camp.robots.go2 import GO2
from camp.runs.folder import REPORT


@pytest.fixture(scope="module")
def report():
    return read_report(policies_root() / "go2_camp" / REPORT, "restore it")


@pytest.fixture(scope="module")
def clip():
    return load_clip(shipped_motions("go2") / "trot_3hz_forward_0.6.npz")


def test_one_skill_of_each_gait_at_the_preferred_frequency():
    skills = ["trot_2hz", "trot_3hz", "pace_2hz", "pace_4hz", "bound"]
    assert one_skill_of_each_gait(skills) == ["trot_3hz", "pace_2hz", "bound"]


def test_touches_per_stance_by_hand():
    # FL: two stances of one touch each; FR: one of three touches; RL never touches down; RR stands throughout.
    raw = np.array([[0, 0, 0, 1], [1, 1, 0, 1], [0, 0, 0, 1], [1, 1, 0, 1], [1, 0, 0, 1], [1, 1, 0, 1]], dtype=bool)
    stance = np.array([[0, 0, 0, 1], [1, 1, 0, 1], [0, 1, 0, 1], [1, 1, 0, 1], [1, 1, 0, 1], [1, 1, 0, 1]], dtype=bool)
    assert touches_per_stance(raw, stance)[:2] == (1.0, 3.0)
    assert np.isnan(touches_per_stance(raw, stance)[2:]).all()


def test_a_shifted_stride_is_fitted_again():
    angle = 2 * np.pi * np.arange(PHASES) / PHASES
    stride = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    cycles = 0.06
    position = np.stack(
        [np.sin(2 * np.pi * (cycles * np.arange(60) + 0.3)), np.cos(2 * np.pi * (cycles * np.arange(60) + 0.3))], axis=1
    )
    np.testing.assert_allclose(fit(stride, position, cycles), position, atol=0.01)


def test_the_experts_own_clip_lies_on_its_mean_stride(clip, report):
    skills = ("trot_2hz", "trot_3hz")
    recording = recording_of(GO2, [clip])
    recording = replace(recording, skill=np.full_like(recording.skill, 1))
    traces = compute_joints(recording, skills, [clip])
    fitted = np.isfinite(traces.expert).all(axis=1)
    assert fitted.sum() == len(fitted) - round(0.75 / 0.02)
    stride = mean_stride(clip.joint_position, 3.0, clip.dt)[:, 7:9]
    error = np.abs(traces.expert - traces.actual)[fitted].mean(axis=0) / np.ptp(stride, axis=0)
    assert (error < 0.05).all()
    assert nearest_clip([clip], "pace_3hz", np.zeros(3)) is None
    assert len(draw_joints(traces, report.reference).axes) == 3


def test_boxes_hold_the_configured_sizes():
    config = compose_config(["run=scratch"])
    boxes = compute_boxes(config)
    assert boxes["actor"].lines[1] == "171 - 256 - 128 - 64 - 12"  # 3 control steps of 45 + 12 skills
    assert boxes["skill"].lines[1] == "3 x 47" and boxes["embedding"].lines[1] == "12 x 64"
    assert "imitation" not in boxes
    assert "style" not in compute_boxes(compose_config(["run=scratch", "+ablation=task_only"]))
    assert draw_data_flow(config).axes


def test_boxes_know_the_history_and_the_imitation():
    config = load_run(policies_root() / "go2_camp").config
    boxes = compute_boxes(config)
    assert boxes["actor"].lines[1].startswith("342 - ")  # 6 control steps of 45 + 12 numbers, as policy.onnx takes
    assert boxes["critic"].lines[1].startswith("408 - ")
    assert boxes["imitation"].lines[2:] == ("130 epochs before PPO", "and beside it, 3 x")
    assert draw_data_flow(config).axes


def test_parameters_grow_with_skills_only_where_each_has_its_own():
    config = compose_config(["run=scratch"])
    cost = compute_cost(config, (1, 2, 4))
    assert cost.separate == [cost.separate[0] * n for n in (1, 2, 4)]
    assert cost.shared[1] - cost.shared[0] == config.algo.embedding_size
    assert draw_cost(cost).axes


def test_confusions_are_fractions_of_the_commanded(report):
    panel = confusion_panel("nominal", report.policies["trained"])
    np.testing.assert_allclose(np.nansum(panel.values, axis=1), 100.0)
    assert panel.columns == [*panel.rows, "none", "fell"]
    right = [accuracy(part) for part in report.policies["trained"].skills.values()]
    np.testing.assert_allclose(np.nan_to_num(np.diag(panel.values)), 100.0 * np.array(right))  # as the tables say
    assert len(draw_confusion(report).axes) == 3 and draw_robustness(report)


def test_parts_that_were_not_evaluated_are_named(report):
    with pytest.raises(AnalysisError, match="part `gait`"):
        draw_confusion(replace(report, policies={}))
    with pytest.raises(AnalysisError, match="suite=full"):
        draw_robustness(replace(report, robustness={}))
