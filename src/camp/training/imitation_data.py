"""Pairs (observation, action) from expert clips, in the layout of the environment's observation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from camp.algo.imitation import ImitationData
from camp.build import build_robot
from camp.config.schema import Config
from camp.envs import observations
from camp.envs.measurement import Measurement, rotate_inverse
from camp.envs.situation import Before, Setup, Situation
from camp.gaits.skills import label_of
from camp.motion.clips.clip import Clip
from camp.robots.robot import Robot
from camp.sim.base import Dynamics


def imitation_data(clips: Sequence[Clip], config: Config, device: torch.device) -> ImitationData:
    """Every row but the first of each clip: what the policy would have observed, and the expert's answer to it.

    The first row is left out because the action before it is not known. The sensors' noise is left to the training,
    which draws it anew for every minibatch.
    """
    robot, skills = build_robot(config.robot), config.motion.skill_set()
    entries = observations.entries_of(config.env.observation.policy, len(skills))
    labels = [label_of(clip.gait, clip.frequency_hz, skills) for clip in clips]
    shown = [(clip, label) for clip, label in zip(clips, labels, strict=True) if label is not None]
    setup = Setup(robot, len(skills), config.env.observe_skill, config.robot.action_scale, config.env.control_period_s)
    situations = [_situation(clip, label, setup, config) for clip, label in shown]
    observation = torch.cat([observations.observe(entries, situation) for situation in situations])
    noise = config.env.noise
    answer = _rows(np.concatenate([clip.joint_target[1:] for clip, _ in shown]))
    return ImitationData(
        observation=observation.to(device),
        action=_as_action(robot, answer, config.robot.action_scale).to(device),
        last_action=observations.position(entries, "last_action"),
        sensor_noise=(observations.noise_width(entries, noise) * noise.enabled).to(device),
    )


def _situation(clip: Clip, label: int, setup: Setup, config: Config) -> Situation:
    num = len(clip) - 1
    quaternion = _rows(clip.base_quaternion[1:])
    down = torch.tensor([0.0, 0.0, -1.0]).expand(num, 3)
    measurement = Measurement(
        base_position=_rows(clip.base_position[1:]),
        linear_velocity=_rows(clip.base_linear_velocity[1:]),
        angular_velocity=_rows(clip.base_angular_velocity[1:]),
        gravity=rotate_inverse(quaternion, down),
        joint_position=_rows(clip.joint_position[1:]),
        joint_velocity=_rows(clip.joint_velocity[1:]),
        foot_position=_rows(clip.foot_position[1:]),
        foot_contact=torch.from_numpy(clip.foot_contact[1:].copy()),
        body_force=torch.zeros(num, 5),
    )
    action = _as_action(setup.robot, _rows(clip.joint_target_applied[:-1]), setup.action_scale)
    return Situation(
        setup=setup,
        measurement=measurement,
        command=_rows(np.broadcast_to(clip.command, (num + 1, 3))[1:]),
        skill=torch.full((num,), label),
        last_action=action,
        average_velocity=measurement.velocity(),
        dynamics=Dynamics.nominal(num, config.env.randomization.nominal_friction, torch.device("cpu")),
        before=Before(torch.cat([action[:1], action[:-1]]), _rows(clip.joint_velocity[:-1])),
    )


def _as_action(robot: Robot, target: Tensor, scale: float) -> Tensor:
    """The network output that asks for a joint target (..., 12) rad."""
    return (target - torch.tensor(robot.default_joint_position)) / scale


def _rows(values: np.ndarray) -> Tensor:
    return torch.from_numpy(np.array(values, dtype=np.float32))
