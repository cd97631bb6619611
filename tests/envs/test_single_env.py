"""The registered single environment passes Gymnasium's own checker."""

from __future__ import annotations

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import camp.envs  # noqa: F401 - registers camp/Go2-v0
from camp.common.errors import CampError
from camp.single_env import Go2Env


def test_gymnasium_check_env():
    env = gymnasium.make("camp/Go2-v0")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # advice, such as to prefer bounded actions; faults raise
        check_env(env.unwrapped, skip_render_check=True)
    env.close()


def test_same_seed_same_episode():
    env = gymnasium.make("camp/Go2-v0", overrides=["run=smoke", "env.episode_s=0.2"])
    runs = []
    for _ in range(2):
        observation, _ = env.reset(seed=5)
        rows = [observation]
        truncated = False
        while not truncated:
            observation, reward, terminated, truncated, info = env.step(np.zeros(12, dtype=np.float32))
            rows.append(observation)
            assert not terminated
        runs.append(np.stack(rows))
    assert len(runs[0]) == 11  # 0.2 s at 50 Hz
    np.testing.assert_array_equal(runs[0], runs[1])
    assert info["transition"].shape == (2, 43) and 0.0 <= reward <= 2.25
    env.close()


def test_a_bad_action_is_refused_before_anything_changes():
    env, other = gymnasium.make("camp/Go2-v0"), gymnasium.make("camp/Go2-v0")
    for one in (env, other):
        one.reset(seed=3)
    zero = np.zeros(12, dtype=np.float32)
    for action in (
        np.zeros(11, np.float32),
        np.zeros((1, 12), np.float32),
        np.zeros(12, int),
        np.full(12, np.nan),
        "x",
    ):
        with pytest.raises(ValueError, match="action"):
            env.unwrapped.step(action)
    np.testing.assert_array_equal(env.step(zero)[0], other.step(zero)[0])
    observation, reward, terminated, _, info = env.step(np.full(12, 1e30, np.float32))
    assert np.isfinite(observation).all() and reward == 0.0 and terminated and info["diverged"]
    env.close()
    other.close()


def test_renders_a_picture_of_the_robot():
    env = gymnasium.make("camp/Go2-v0", render_mode="rgb_array")
    env.reset(seed=0)
    try:
        picture = env.render()
    except CampError as error:
        pytest.skip(str(error))
    assert picture.shape == (480, 640, 3) and picture.dtype == np.uint8
    assert picture.std() > 10  # not a single colour
    env.close()


def test_unknown_render_mode_is_an_error():
    with pytest.raises(ValueError, match="depth"):
        Go2Env(render_mode="depth")
