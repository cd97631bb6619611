"""Reading a run folder: what is there arrives whole, what is not is named."""

from __future__ import annotations

import os
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from analysis.load import (
    AnalysisError,
    ClipFeatures,
    NoLatentSpaceError,
    clip_features,
    first_touchdown,
    gaits_of,
    learning_curve,
    newest_run,
)
from camp.algo.models import SkillEmbedding
from camp.algo.skill import SkillPrior
from camp.common.errors import CampError
from camp.config.compose import compose_config
from camp.data import Transition
from camp.gaits.schedule import GaitSchedule
from camp.motion.clips.clip import Clip, amp_state
from tests.algo.synthetic import shipped_config
from tests.analysis.synthetic import metrics, write_evaluation, write_metrics


def expert_clip(steps: int) -> Clip:
    """Random states with the contacts of a 2-Hz trot, (steps, ...)."""
    rng = np.random.default_rng(0)

    def rows(*shape: int) -> np.ndarray:
        return rng.normal(size=(steps, *shape)).astype(np.float32)

    return Clip(
        dt=0.02,
        gait="trot",
        frequency_hz=2.0,
        command=np.array([0.5, 0.0, 0.0], dtype=np.float32),
        base_position=rows(3),
        base_quaternion=np.tile(np.array([1, 0, 0, 0], dtype=np.float32), (steps, 1)),
        joint_position=rows(12),
        joint_velocity=rows(12),
        base_linear_velocity=rows(3),
        base_angular_velocity=rows(3),
        foot_position=rows(4, 3),
        foot_velocity=rows(4, 3),
        foot_contact=GaitSchedule("trot", 2.0).contact(np.arange(steps) * 0.02),
        joint_target=rows(12),
        joint_target_applied=rows(12),
        joint_torque=rows(12),
    )


def run_with(prior: SkillPrior | None, clips: list[Clip]) -> Any:
    """What the figures read of a trained run."""
    return SimpleNamespace(skill_prior=prior, clips=clips, config=compose_config(["run=smoke"]))


def test_newest_run_is_the_last_evaluated(tmp_path):
    for age, name in enumerate(["third", "second", "first"]):
        folder = write_evaluation(tmp_path / "group" / name)
        os.utime(folder / "eval.npz", (1000 - age, 1000 - age))
    (tmp_path / "never_evaluated").mkdir()
    assert newest_run(tmp_path).name == "third"


def test_no_run_at_all_is_named(tmp_path):
    with pytest.raises(AnalysisError, match=r"no eval\.npz below"):
        newest_run(tmp_path)


class TestClipFeatures:
    @pytest.fixture
    def prior(self):
        weights = torch.Generator().manual_seed(0)
        return SkillPrior(shipped_config().skill, SkillEmbedding(4, 8, weights), ("trot",) * 4, (2, 43), weights)

    def test_one_latent_vector_per_transition(self, prior):
        clip = expert_clip(steps=60)
        (found,) = clip_features(run_with(prior, [clip]))
        assert found.feature.shape == (59, 8) and np.isfinite(found.feature).all()
        assert (found.gait, found.frequency_hz, found.period_s) == ("trot", 2.0, 0.02)
        assert found.touchdown == 25  # FL stands in rows 0-12, lands again after one stride of 25 rows
        state = torch.from_numpy(amp_state(clip))
        pair = Transition(torch.stack([state[7], state[8]])[None], torch.zeros(1, dtype=torch.int64))
        np.testing.assert_allclose(found.feature[7], prior.predict(pair)[0].numpy(), atol=1e-5)

    def test_clips_of_changing_command_are_left_out(self, prior):
        changing = replace(expert_clip(steps=60), command=np.zeros((60, 3), dtype=np.float32))
        assert len(clip_features(run_with(prior, [changing, expert_clip(steps=60)]))) == 1

    def test_a_run_without_skill_discriminator_is_refused(self):
        with pytest.raises(NoLatentSpaceError, match="no skill discriminator"):
            clip_features(run_with(None, [expert_clip(steps=60)]))


def test_gaits_keep_their_order_whatever_the_files_are_called():
    clip = ClipFeatures("pronk", 2.0, np.zeros(3), np.zeros((9, 2)), 0, 0.02)
    names = ["pronk", "amble", "pace", "trot", "pace"]
    assert gaits_of([replace(clip, gait=name) for name in names]) == ["trot", "pace", "pronk", "amble"]


def test_first_touchdown_is_a_landing_not_a_stance():
    assert first_touchdown(np.array([True, True, False, False, True, True])) == 4
    assert first_touchdown(np.array([False, True])) == 1
    assert first_touchdown(np.array([True, True, False])) == 0


def test_learning_curve_needs_an_iteration(tmp_path):
    assert learning_curve(write_metrics(tmp_path, metrics(3))) == metrics(3)
    with pytest.raises(AnalysisError, match=r"metrics\.jsonl' holds no iteration"):
        learning_curve(write_metrics(tmp_path, []))
    with pytest.raises(CampError, match="unreadable"):
        learning_curve(tmp_path / "none")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"steps": "a"}, "steps = 'a' at iteration 2, which is no number"),
        ({"steps": [1.0]}, "which is no number"),
        ({"steps": float("nan")}, "which is no number"),
        ({"ppo/kl": {}}, "ppo/kl = {}"),
        ({"prior/style/logit_histogram/policy": 1.0}, "which is no histogram"),
        ({"prior/style/logit_histogram/policy": [1.0]}, "which is no histogram"),
    ],
)
def test_metrics_of_another_kind_are_named(change, words, tmp_path):
    rows = metrics(3)
    rows[1] |= change
    with pytest.raises(CampError) as error:
        learning_curve(write_metrics(tmp_path, rows))
    assert words in str(error.value) and "metrics.jsonl" in str(error.value)
