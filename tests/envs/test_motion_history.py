"""What the discriminators see: states of the configured ages, how episodes begin, the feet's stance."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from camp.common.errors import ConfigError
from camp.envs.measurement import foot_height, measure
from camp.motion.clips.clip import amp_state, discriminator_state
from camp.motion.clips.stance import with_foot_stance
from camp.robots.go2 import GO2
from tests.envs.batched import ZERO, make


def test_transitions_hold_states_of_the_configured_ages(config, clips):
    config.env.transition_ages = [5, 2, 0]
    env = make(config, clips)
    seen = list(env.motion.states.unbind(dim=1))
    assert len(seen) == 5
    for _ in range(8):
        step = env.advance(ZERO)
        seen.append(step.transition[:, -1])
        on = ~(step.terminated | step.truncated)
        torch.testing.assert_close(step.transition[on], torch.stack([seen[-6], seen[-3], seen[-1]], dim=1)[on])
        if not on.all():
            break


def test_an_episode_begins_with_its_clips_past_or_with_having_stood(config, clips):
    config.env.transition_ages = [4, 0]
    config.env.initialization.reference_fraction = 1.0
    env = make(config, clips)
    states = [amp_state(clip) for clip in clips]
    windows = np.concatenate([np.stack([s[i : len(s) - 3 + i] for i in range(4)], axis=1) for s in states])
    for robot in range(8):
        assert np.abs(windows - env.motion.states[robot].numpy()).max(axis=(1, 2)).min() < 1e-4
    config.env.initialization.reference_fraction = 0.0
    standing = make(config, clips).motion.states
    assert torch.equal(standing, standing[:, -1:].expand(-1, 4, -1)) and (standing[..., 12:24] == 0).all()


@pytest.fixture
def bounds(config, clips):
    """Three bounds with their stance, and ``config`` for them."""
    config.env.foot_stance, config.env.transition_ages, config.motion.skills = True, [4, 0], ["bound"]
    config.env.initialization.reference_fraction = 1.0
    return with_foot_stance(GO2, [clip for clip in clips if clip.gait == "bound"][:3], 0.005)


def test_foot_stance_follows_the_amp_states(config, bounds):
    env = make(config, bounds)
    for _ in range(3):
        step = env.advance(ZERO)
        going = ~(step.terminated | step.truncated)
        torch.testing.assert_close(step.transition[going, 1, 43:], env.sim.state.foot_stance[going])
        torch.testing.assert_close(env.motion.newest[going, :43], measure(GO2, env.sim.state).amp_state()[going])


def test_an_episode_begins_with_the_stance_of_its_clip_or_on_the_feet_that_are_down(config, bounds):
    states = [discriminator_state(clip) for clip in bounds]
    windows = np.concatenate([np.stack([s[i : len(s) - 3 + i] for i in range(4)], axis=1) for s in states])
    env = make(config, bounds)
    for robot in range(8):
        assert np.abs(windows - env.motion.states[robot].numpy()).max(axis=(1, 2)).min() < 1e-4
    config.env.initialization.reference_fraction = 0.0
    standing = make(config, bounds)
    down = foot_height(GO2, measure(GO2, standing.sim.state)) < 1e-3
    assert down.sum(dim=1).min() >= 1 and not down.all()  # joints are drawn, and the lowest foot is on the ground
    assert torch.equal(standing.motion.states[..., 43:], down.float()[:, None].expand(-1, 4, -1))


@pytest.mark.parametrize("ages", [[0], [1], [0, 1], [2, 2, 0], []])
def test_ages_that_are_no_order_are_refused(config, ages):
    config.env.transition_ages = ages
    with pytest.raises(ConfigError, match=r"env\.transition_ages"):
        config.env.check()
