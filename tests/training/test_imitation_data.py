"""Imitation pairs are what the environment would have shown, and what it would take to act as the expert did."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from camp.build import build_env
from camp.robots.go2 import GO2
from camp.training.imitation_data import imitation_data


def test_pairs_of_a_clip_by_hand(config, clips):
    clip = next(clip for clip in clips if clip.gait == "pace")
    data = imitation_data([clip], config, torch.device("cpu"))
    assert data.observation.shape == (len(clip) - 1, 49)
    row, t = data.observation[9].numpy(), 10
    pose = np.array(GO2.default_joint_position)
    np.testing.assert_allclose(row[0:3], clip.base_angular_velocity[t], atol=1e-6)
    np.testing.assert_allclose(row[6:9], clip.command, atol=1e-6)
    np.testing.assert_allclose(row[9:21], clip.joint_position[t] - pose, atol=1e-6)
    np.testing.assert_allclose(row[33:45], (clip.joint_target_applied[t - 1] - pose) / 0.25, atol=1e-5)
    assert row[45:].tolist() == [0, 1, 0, 0]
    np.testing.assert_allclose(data.action[9].numpy() * 0.25 + pose, clip.joint_target[t], atol=1e-5)
    assert data.last_action == slice(33, 45)


@pytest.mark.parametrize(("delay", "rows", "share"), [(0.02, 1, 0.0), (0.005, 0, 0.25), (0.03, 1, 0.5)])
def test_late_targets_by_hand(config, clips, delay, rows, share):
    """The answer is what the expert asks for once it arrives; the last action is what has yet to arrive."""
    clip = clips[0]
    config.env.randomization.enabled, config.env.randomization.delay_s = True, [delay, delay]
    data = imitation_data([clip], config, torch.device("cpu"))
    assert len(data.action) == len(clip) - 1 - rows - (share > 0)
    pose, t = np.array(GO2.default_joint_position), 10
    answer, applied = clip.joint_target[t + rows :], clip.joint_target_applied[t - 1 + rows :]
    late = (1 - share) * answer[0] + share * answer[1]
    np.testing.assert_allclose(data.action[t - 1].numpy() * 0.25 + pose, late, atol=1e-5)
    on_its_way = (1 - share) * applied[0] + share * applied[1]
    np.testing.assert_allclose(data.observation[t - 1, 33:45].numpy() * 0.25 + pose, on_its_way, atol=1e-5)
    np.testing.assert_allclose(data.observation[t - 1, 9:21].numpy() + pose, clip.joint_position[t], atol=1e-5)


def test_history_by_hand(config, clips):
    config.env.observation.history = 3
    data = imitation_data([clips[0]], config, torch.device("cpu"))
    pose = np.array(GO2.default_joint_position)
    for row, seen in ((9, (8, 9, 10)), (1, (1, 1, 2)), (0, (1, 1, 1))):  # a clip's first row is not among the pairs
        position = data.observation[row].unflatten(0, (3, 49))[:, 9:21].numpy() + pose
        np.testing.assert_allclose(position, clips[0].joint_position[list(seen)], atol=1e-5)
    assert data.last_action == slice(33, 45) and data.sensor_noise.shape == (49,)


def test_delays_count_only_where_robots_are_randomized(config, clips):
    prompt = imitation_data(clips, config, torch.device("cpu"))
    config.env.randomization.enabled, config.env.randomization.delay_s = False, [0.02, 0.02]
    nominal = imitation_data(clips, config, torch.device("cpu"))
    assert torch.equal(prompt.observation, nominal.observation) and torch.equal(prompt.action, nominal.action)


def test_the_environment_shows_the_same_observation(config, clips):
    """A robot set into a frame of a clip observes exactly what the imitation data holds for that frame."""
    config.env.initialization.reference_fraction = 1.0
    env = build_env(config, clips)
    observation, _ = env.reset(seed=3, options={"stagger": False})
    data = imitation_data(clips, config, torch.device("cpu"))
    for robot in range(env.num_envs):
        nearest = (data.observation - observation[robot]).abs().amax(dim=1).min()
        assert nearest < 1e-3


def test_a_hidden_skill_is_hidden_from_imitation_too(config, clips):
    config.env.observe_skill = False
    data = imitation_data(clips[:2], config, torch.device("cpu"))
    assert (data.observation[:, 45:] == 0).all()


def test_clips_that_show_no_skill_are_left_out(config, clips):
    config.motion.labels, config.motion.frequencies_hz = "gait_frequency", [3.0]
    two = [next(c for c in clips if c.frequency_hz == f) for f in (2.0, 3.0)]
    data = imitation_data(two, config, torch.device("cpu"))
    assert data.observation.shape == (len(two[1]) - 1, 45 + 4)
    alone = imitation_data(two[1:], config, torch.device("cpu"))
    assert torch.equal(data.observation, alone.observation) and torch.equal(data.action, alone.action)


def test_the_applied_targets_replay_the_clip(config, clips):
    """Actions taken from a clip, through the environment's own action scale and PD, reproduce its motion."""
    config.env.initialization.reference_fraction = 1.0
    config.sim.num_envs = 1
    clip = next(clip for clip in clips if clip.gait == "trot")
    data = imitation_data([clip], config, torch.device("cpu"))
    env = build_env(config, [clip, *(c for c in clips if c.gait != "trot")])
    for _ in range(100):  # until the first robot starts as a trot
        env.reset(options={"stagger": False})
        row = int((data.observation - env.observation[0]).abs().amax(dim=1).argmin())
        distance = float((data.observation[row] - env.observation[0]).abs().max())
        if distance < 1e-3 and row < len(data.action) - 26:
            break
    assert distance < 1e-3
    for t in range(row, row + 25):  # half a second
        env.advance(data.action[t : t + 1])
    error = env.sim.state.joint_position[0].numpy() - clip.joint_position[row + 26]
    assert np.sqrt((error**2).mean()) < 0.1
