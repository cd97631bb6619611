"""`camp/Go2-v0` as others use it: Gymnasium's wrappers and vectors, and another project's PPO."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.utils.env_checker import check_env

import camp.envs  # noqa: F401 - registers camp/Go2-v0
from camp.common.errors import CampError
from camp.envs.spaces import useful_actions
from camp.robots.go2 import GO2

FEW = ["motion.skills=[trot]", "motion.frequencies_hz=[2]", "motion.mirrored=false", "env.episode_s=0.2", "run=smoke"]


def make(**arguments) -> gymnasium.Env:
    return gymnasium.make("camp/Go2-v0", overrides=FEW, **arguments)


def test_the_bounds_of_actions_leave_nothing_out():
    """At both ends every joint's motor gives its full torque, wherever the joint is and however fast it turns."""
    space, scale = useful_actions(GO2, 0.25), 0.25
    pose = np.array(GO2.default_joint_position)
    for bound, place, sign in ((space.low, GO2.joint_lower, -1.0), (space.high, GO2.joint_upper, 1.0)):
        target, speed = pose + scale * bound, sign * np.array(GO2.joint_speed_limit)
        torque = GO2.pd_gain_p * (target - np.array(place)) - GO2.pd_gain_d * speed
        np.testing.assert_allclose(sign * torque, GO2.torque_limit, rtol=1e-4)


def test_wrappers_of_gymnasium():
    env = make(max_episode_steps=5)
    env = wrappers.RecordEpisodeStatistics(wrappers.NormalizeReward(wrappers.NormalizeObservation(env)))
    env = wrappers.FlattenObservation(wrappers.FrameStackObservation(env, 3))
    observation, _ = env.reset(seed=0)
    assert observation.shape == env.observation_space.shape == (3 * 46,)
    for step in range(1, 6):
        observation, reward, terminated, truncated, info = env.step(np.zeros(12, np.float32))
        assert observation.shape == (3 * 46,) and np.isfinite(observation).all() and np.isfinite(reward)
        assert truncated == (step == 5) and not terminated
    assert info["episode"]["l"] == 5
    env.close()


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_vectors_of_gymnasium(mode):
    vector = gymnasium.make_vec("camp/Go2-v0", 2, vectorization_mode=mode, overrides=FEW)
    observation, _ = vector.reset(seed=[0, 1])
    assert observation.shape == (2, 46) and not np.array_equal(observation[0], observation[1])
    ends = 0
    for _ in range(25):
        observation, reward, _, truncated, _ = vector.step(np.zeros((2, 12), np.float32))
        assert np.isfinite(observation).all() and reward.shape == (2,)
        ends += int(truncated.sum())
    assert ends == 4  # episodes of 10 steps, and a step for each new start
    vector.close()


def test_the_checker_in_every_render_mode():
    env = make(render_mode="rgb_array")
    try:
        env.reset(seed=0)
        env.render()
    except CampError as error:
        pytest.skip(str(error))
    env.close()
    with pytest.warns(UserWarning):  # advice, such as to prefer bounded actions; faults raise
        check_env(make(render_mode="rgb_array").unwrapped)


def test_videos_of_gymnasium(tmp_path):
    pytest.importorskip("moviepy", reason="gymnasium's RecordVideo needs moviepy")
    env = make(render_mode="rgb_array")
    try:
        env.reset(seed=0)
        env.render()
    except CampError as error:
        pytest.skip(str(error))
    env = wrappers.RecordVideo(env, str(tmp_path), episode_trigger=lambda _: True)
    env.reset(seed=0)
    truncated = False
    while not truncated:
        *_, truncated, _ = env.step(np.zeros(12, np.float32))
    env.close()
    assert [path.stat().st_size > 1000 for path in tmp_path.glob("*.mp4")] == [True]


@pytest.mark.parametrize("robots", [1, 2])
def test_the_ppo_of_stable_baselines(robots):
    baselines = pytest.importorskip("stable_baselines3", reason="pip install stable-baselines3")
    from stable_baselines3.common.vec_env import DummyVecEnv

    env = make() if robots == 1 else DummyVecEnv([make] * robots)
    model = baselines.PPO("MlpPolicy", env, n_steps=32, batch_size=32, n_epochs=1, seed=0, device="cpu")
    model.learn(64 * robots)
    observation = env.reset()[0] if robots == 1 else env.reset()
    action, _ = model.predict(observation)
    assert action.shape == ((12,) if robots == 1 else (robots, 12)) and np.isfinite(action).all()
    env.close()
