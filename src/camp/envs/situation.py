"""What observation entries and reward terms see: N robots at one moment."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs.measurement import Measurement
from camp.robots.robot import Robot
from camp.sim.base import Dynamics
from camp.sim.motors import MotorLaw


@dataclass(frozen=True)
class Setup:
    """What is the same for all robots and at all times."""

    robot: Robot  # with the nominal gains of the PD law
    num_skills: int  # K
    observe_skill: bool  # false: an ablation hides the skill
    action_scale: float  # rad per unit of the network's output
    control_period: float  # s


@dataclass
class Before:
    """One control step earlier."""

    action: Tensor  # (N, 12) network output
    joint_velocity: Tensor  # (N, 12) rad/s


@dataclass
class Situation:
    """N robots at the end of a control step. What is derived is computed when it is first asked for."""

    setup: Setup
    measurement: Measurement
    command: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s
    skill: Tensor  # (N,) int64 label
    last_action: Tensor  # (N, 12) network output of the step
    average_velocity: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s, of about the last stride
    dynamics: Dynamics
    before: Before

    @cached_property
    def skill_one_hot(self) -> Tensor:
        """(N, K)."""
        labels = constant(tuple(range(self.setup.num_skills)), self.skill)
        return (self.skill[:, None] == labels).float()

    @cached_property
    def joint_target(self) -> Tensor:
        """(N, 12) rad, held during the step: default pose + k action."""
        pose = constant(self.setup.robot.default_joint_position, self.last_action)
        return pose + self.setup.action_scale * self.last_action

    @cached_property
    def torque(self) -> Tensor:
        """(N, 12) N m, of the PD law with each robot's own motors, at the end of the step."""
        measured = self.measurement
        law = MotorLaw.of(self.setup.robot, self.dynamics)
        return law.torque(self.joint_target, measured.joint_position, measured.joint_velocity)

    @cached_property
    def joint_acceleration(self) -> Tensor:
        """(N, 12) rad/s^2, mean over the step."""
        return (self.measurement.joint_velocity - self.before.joint_velocity) / self.setup.control_period

    @cached_property
    def foot_contact(self) -> Tensor:
        """(N, 4) 1 where a foot carries load, else 0."""
        return self.measurement.foot_contact.to(torch.float32)
