"""How episodes begin: standing or in a clip, with what was observed before, drawn anew on a clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from camp.envs.measurement import measure
from camp.envs.quadruped import STARTS_PERIOD_S
from camp.motion.clips.clip import amp_state
from camp.robots.go2 import GO2
from camp.sim.base import Dynamics
from tests.envs.batched import ZERO, make


def test_an_episode_begins_without_the_history_of_the_one_before(config, clips):
    config.env.observation.history = 2
    config.env.initialization.reference_fraction, config.env.noise.enabled = 0.0, False
    env = make(config, clips)
    env.advance(ZERO)
    step = env.advance(ZERO, give_up=torch.ones(8, dtype=torch.bool))
    assert torch.equal(step.observation[:, :49], step.observation[:, 49:])
    assert not torch.equal(step.final_observation[:, :49], step.final_observation[:, 49:])


def test_a_robot_set_into_a_clip_has_observed_the_clip(config, clips):
    config.env.observation.history = 3
    config.env.initialization.reference_fraction, config.env.noise.enabled = 1.0, False
    env = make(config, clips)
    joint_position, last_action = slice(9, 21), slice(33, 45)
    pose = np.array(GO2.default_joint_position, np.float32)
    starts = env._pool.starts.initial.joint_position.numpy()
    for frames, start in zip(env.observation.view(8, 3, 49).numpy(), starts, strict=True):
        (clip, row) = next(
            (clip, row) for clip in clips for row in np.flatnonzero((clip.joint_position == start).all(axis=1)).tolist()
        )
        rows = slice(row - 2, row + 1)
        np.testing.assert_allclose(frames[:, joint_position], clip.joint_position[rows] - pose, atol=1e-6)
        targets = clip.joint_target_applied[row - 3 : row]
        np.testing.assert_allclose(frames[:, last_action], (targets - pose) / env.action_scale, atol=1e-5)


def test_a_late_robot_set_into_a_clip_goes_on_with_the_clips_target(config, clips):
    config.env.initialization.reference_fraction = 1.0
    nominal, reached = Dynamics.nominal(8, 0.8, torch.device("cpu")), {}
    for delay in (0.0, 0.02):
        env = make(config, clips)
        dynamics = replace(nominal, delay=torch.full((8,), delay))
        env.reset(seed=0, options={"stagger": False, "dynamics": dynamics})
        held = (env._pool.starts.joint_target - env.default_pose) / env.action_scale
        env.advance(held if delay == 0.0 else ZERO)
        reached[delay] = env.sim.state.qpos()
    assert torch.equal(reached[0.0], reached[0.02])


def test_reference_state_initialization_starts_in_a_clip(config, clips):
    config.env.initialization.reference_fraction = 1.0
    env = make(config, clips)
    for robot in range(8):
        skill = config.motion.skills[int(env.skill[robot])]
        states = np.concatenate([amp_state(clip) for clip in clips if clip.gait == skill])
        assert np.abs(states - env.motion.newest[robot].numpy()).max(axis=1).min() < 1e-4


def test_standing_start_is_at_rest_on_the_ground(config, clips):
    config.env.initialization.reference_fraction = 0.0
    env = make(config, clips)
    state = env.sim.state
    assert (state.joint_velocity == 0).all() and (env.last_action == 0).all()
    ratio = state.joint_position.view(8, 4, 3)[..., 1:] / torch.tensor([0.9, -1.8])
    assert ratio.min() >= 0.5 and ratio.max() <= 2.7227 / 1.8 + 1e-4
    env.advance(ZERO)
    assert env.sim.state.base_position[:, 2].max() < 0.45


def test_starts_are_drawn_anew_on_a_clock(config, clips):
    config.env.randomization.enabled, config.env.initialization.reference_fraction = True, 1.0
    config.env.episode_s = STARTS_PERIOD_S
    env = make(config, clips)
    steps = round(STARTS_PERIOD_S / 0.02)
    first = env.motion.newest.clone(), env.dynamics.payload_mass.clone()
    for _ in range(steps):
        env.advance(ZERO)
    assert (env.step_count == 0).all()  # every episode has ended, and begun with another start
    assert not (first[0] == env.motion.newest).all(dim=1).any()
    assert not (first[1] == env.dynamics.payload_mass).any()


def test_a_start_is_what_the_simulator_then_shows(config, clips):
    config.env.randomization.enabled = True
    env = make(config, clips)
    measured = measure(env.robot, env.sim.state)
    torch.testing.assert_close(env.motion.newest, measured.amp_state())
    observation = env.set_command(env.command, env.skill)
    env.reset(seed=0, options={"stagger": False})
    torch.testing.assert_close(env.observation, observation)
    torch.testing.assert_close(env.privileged[:, 3], env.sim.state.base_position[:, 2])
    assert (env.privileged[:, 4:8] == 0).all() and (env.sim.state.foot_force == 0).all()  # no force felt yet
