"""A simulation that diverges ends its episode and spoils nothing."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from tests.envs.batched import ZERO, make


def test_a_diverged_simulation_ends_its_episode_and_stays_finite(config, clips):
    env = make(config, clips)
    env.sim._rows["qvel"][3] = np.nan  # pyright: ignore[reportAttributeAccessIssue]
    step = env.advance(ZERO)
    assert step.terminated[3] and env.num_diverged == 1
    for tensor in (
        step.observation,
        step.final_observation,
        step.privileged,
        step.transition,
        step.task_reward,
    ):
        assert torch.isfinite(tensor).all()
    assert torch.isfinite(env.advance(ZERO).observation).all()


@pytest.mark.parametrize("speed", [1e8, 1e200, 1000.0])
def test_an_impossible_state_ends_its_episode_without_reward_and_reaches_nothing(config, clips, speed):
    config.env.reward.terms["joint_acceleration"] = {"weight": -1e-3}
    env, other = make(config, clips), make(config, clips)
    env.sim._rows["qvel"][3, 8] = speed  # pyright: ignore[reportAttributeAccessIssue]
    step, healthy = env.advance(ZERO), other.advance(ZERO)
    assert step.diverged.tolist() == step.terminated.tolist() == [row == 3 for row in range(8)]
    assert step.task_reward[3] == 0.0 and env.num_diverged == 1 and not healthy.diverged.any()
    for name in ("observation", "final_observation", "privileged", "final_privileged", "transition", "velocity"):
        assert getattr(step, name).abs().max() < 100.0, name
    others = torch.arange(8) != 3
    assert torch.equal(step.final_observation[others], healthy.final_observation[others])


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e30, -2e3])
def test_an_action_of_no_use_counts_as_diverged(config, clips, value, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    env = make(config, clips)
    action = torch.zeros(8, 12)
    action[5, 2] = value
    step = env.advance(action)
    assert step.diverged.nonzero().tolist() == [[5]] and step.terminated[5] and step.task_reward[5] == 0.0
    assert torch.isfinite(step.observation).all() and torch.isfinite(step.final_observation).all()
    assert not env.advance(ZERO).diverged.any()
    assert list(tmp_path.iterdir()) == []  # no MUJOCO_LOG.TXT


def test_a_diverging_simulation_leaves_no_log(config, clips, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    env = make(config, clips)
    env.sim._rows["qvel"][:] = np.nan  # pyright: ignore[reportAttributeAccessIssue]
    assert env.advance(ZERO).diverged.all() and list(tmp_path.iterdir()) == []
