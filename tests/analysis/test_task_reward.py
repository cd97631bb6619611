"""What the task reward pays the expert."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analysis.task_reward import reward_of, reward_of_standing
from camp.build import motion_folder
from camp.config.compose import compose_config
from camp.motion.clips.store import load_clip

REWARD = compose_config([]).env.reward


@pytest.fixture(scope="module")
def clip():
    return load_clip(motion_folder(compose_config([])) / "pace_2hz_forward_0.3.npz")


def test_standing_still_by_hand(clip):
    assert reward_of_standing(clip, REWARD) == pytest.approx(1.5 * math.exp(-2.0) + 0.75, rel=1e-4)


def test_a_body_that_moves_exactly_as_commanded_gets_everything(clip):
    exact = replace(
        clip,
        base_linear_velocity=np.tile(np.float32([0.3, 0.0, 9.0]), (len(clip), 1)),
        base_angular_velocity=np.tile(np.float32([9.0, 9.0, 0.0]), (len(clip), 1)),
    )
    for time_constant in (0.0, 0.5):
        assert reward_of(exact, REWARD, time_constant) == pytest.approx(2.25, rel=1e-4)


def test_a_pace_is_hardly_paid_unless_its_sway_is_averaged(clip):
    assert reward_of(clip, REWARD, 0.0) < 1.1 < 1.7 < reward_of(clip, REWARD, 0.5)
