"""Pairs (observation, action) from expert clips, in the layout of the environment's observation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from camp.algo.imitation import ImitationData
from camp.build import build_robot
from camp.common.seeding import generator
from camp.config.schema import Config
from camp.envs import observations
from camp.envs.config import RandomizationConfig
from camp.envs.measurement import Measurement, rotate_inverse
from camp.envs.randomization import sample_delays
from camp.envs.situation import Before, Setup, Situation
from camp.gaits.skills import label_of
from camp.motion.clips.clip import Clip
from camp.robots.quadruped import NUM_JOINTS
from camp.robots.robot import Robot
from camp.sim.base import Dynamics


def imitation_data(clips: Sequence[Clip], config: Config, device: torch.device) -> ImitationData:
    """Every row but the first of each clip: what the policy would have observed, and the expert's answer to it.

    The first row is left out because the action before it is not known. The sensors' noise is left to the training,
    which draws it anew for every minibatch. Where ``env.randomization.delay_s`` makes targets reach the motors late,
    each clip has a delay of its own, and the answer is what the expert asked for by then; a clip's last rows, whose
    answer would lie behind its end, are left out.
    """
    robot, skills = build_robot(config.robot), config.motion.skill_set()
    entries = observations.entries_of(config.env.observation.policy, len(skills))
    labels = [label_of(clip.gait, clip.frequency_hz, skills) for clip in clips]
    shown = [(clip, label) for clip, label in zip(clips, labels, strict=True) if label is not None]
    setup = Setup(robot, len(skills), config.env.observe_skill, config.robot.action_scale, config.env.control_period_s)
    delays = generator(config.seed, "imitation delays")
    width = config.env.observation.history * observations.size(entries)
    observation, answer = [torch.zeros(0, width)], [torch.zeros(0, NUM_JOINTS)]
    for clip, label in shown:
        late = _delays(clip, config.env.randomization, delays)
        frames = observations.observe(entries, _situation(clip, label, late, setup, config))
        observation.append(_with_history(frames, config.env.observation.history))
        answer.append(_as_action(robot, _arriving(clip.joint_target[1:], late, clip.dt), config.robot.action_scale))
    noise = config.env.noise
    return ImitationData(
        observation=torch.cat(observation).to(device),
        action=torch.cat(answer).to(device),
        last_action=observations.position(entries, "last_action"),
        sensor_noise=(observations.noise_width(entries, noise) * noise.enabled).to(device),
    )


def _delays(clip: Clip, config: RandomizationConfig, delays: torch.Generator) -> Tensor:
    """The clip's delay in s for each row from the second on, (M,), without rows whose answer may arrive after the
    clip."""
    longest = math.ceil(config.delay_s[1] / clip.dt) if config.enabled else 0
    return sample_delays(1, config, delays).expand(max(len(clip) - 1 - longest, 0))


def _with_history(frames: Tensor, history: int) -> Tensor:
    """The last ``history`` rows up to each row of ``frames`` (M, O), the oldest first, (M, history O); the first row
    stands for those before it, as where an episode begins."""
    row = torch.arange(len(frames))
    return torch.cat([frames[(row - age).clamp(min=0)] for age in reversed(range(history))], dim=1)


def _arriving(targets: np.ndarray, delay: Tensor, period: float) -> Tensor:
    """What the motors are to hold on average in a control step that begins ``delay`` (M,) s after each row, (M, 12).

    targets: (>= M + the longest delay in rows, 12) rad, each held for ``period`` s.
    """
    late = delay / period
    rows = torch.arange(len(late)) + late.long()
    before, after = _rows(targets)[rows], _rows(targets)[(rows + 1).clamp(max=len(targets) - 1)]
    return torch.lerp(before, after, late.frac()[:, None])


def _situation(clip: Clip, label: int, delay: Tensor, setup: Setup, config: Config) -> Situation:
    """What surrounds the policy in M rows of a clip from the second on, whose targets arrive ``delay`` (M,) s late."""
    num = len(delay)
    shown = slice(1, num + 1)
    quaternion = _rows(clip.base_quaternion[shown])
    down = torch.tensor([0.0, 0.0, -1.0]).expand(num, 3)
    measurement = Measurement(
        base_position=_rows(clip.base_position[shown]),
        linear_velocity=_rows(clip.base_linear_velocity[shown]),
        angular_velocity=_rows(clip.base_angular_velocity[shown]),
        gravity=rotate_inverse(quaternion, down),
        joint_position=_rows(clip.joint_position[shown]),
        joint_velocity=_rows(clip.joint_velocity[shown]),
        foot_position=_rows(clip.foot_position[shown]),
        foot_contact=torch.from_numpy(clip.foot_contact[shown].copy()),
        body_force=torch.zeros(num, 5),
    )
    action = _as_action(setup.robot, _arriving(clip.joint_target_applied, delay, clip.dt), setup.action_scale)
    dynamics = Dynamics.nominal(num, config.env.randomization.nominal_friction, torch.device("cpu"))
    return Situation(
        setup=setup,
        measurement=measurement,
        command=_rows(np.broadcast_to(clip.command, (len(clip), 3))[shown]),
        skill=torch.full((num,), label),
        last_action=action,
        average_velocity=measurement.velocity(),
        dynamics=replace(dynamics, delay=delay),
        before=Before(torch.cat([action[:1], action[:-1]]), _rows(clip.joint_velocity[:num])),
    )


def _as_action(robot: Robot, target: Tensor, scale: float) -> Tensor:
    """The network output that asks for a joint target (..., 12) rad."""
    return (target - torch.tensor(robot.default_joint_position)) / scale


def _rows(values: np.ndarray) -> Tensor:
    return torch.from_numpy(np.array(values, dtype=np.float32))
