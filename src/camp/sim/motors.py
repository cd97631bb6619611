"""The PD law as a formula: simulators apply it at every physics step, but do not report the torque."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots.robot import PerJoint, Robot
from camp.sim.base import Dynamics


@dataclass
class MotorLaw:
    """The PD law of N robots: strength (kp (target - q) - kd q'), clipped at the joint's torque limit."""

    stiffness: Tensor  # (N, 12) N m/rad
    damping: Tensor  # (N, 12) N m s/rad
    limit: PerJoint  # N m

    @classmethod
    def of(cls, robot: Robot, dynamics: Dynamics) -> MotorLaw:
        """The law with the robot's nominal gains and each copy's own deviations."""
        strength = dynamics.motor_strength
        kp, kd = (constant(gain, strength) for gain in (robot.pd_gain_p, robot.pd_gain_d))
        return cls(kp * dynamics.kp_scale * strength, kd * dynamics.kd_scale * strength, robot.torque_limit)

    def torque(self, joint_target: Tensor, joint_position: Tensor, joint_velocity: Tensor) -> Tensor:
        """(N, 12) N m, from rad and rad/s."""
        limit = constant(self.limit, joint_position)
        wanted = self.stiffness * (joint_target - joint_position) - self.damping * joint_velocity
        return torch.clamp(wanted, -limit, limit)
