"""What follows from the robots' state: joint torques."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots.robot import PerJoint, Robot
from camp.sim.base import Dynamics


@dataclass
class MotorLaw:
    """The PD law of N robots: strength (kp (target - q) - kd q'), clipped at the joint's torque limit.

    `camp.sim.base.Simulator` says the same; here it is computed once more because simulators report no torques.
    """

    stiffness: Tensor  # (N, 12) N m/rad
    damping: Tensor  # (N, 12) N m s/rad
    limit: PerJoint  # N m

    @classmethod
    def of(cls, robot: Robot, dynamics: Dynamics) -> MotorLaw:
        """The law with the robot's nominal gains and each copy's own deviations."""
        kp, kd = (torch.tensor(gains) for gains in (robot.pd_gain_p, robot.pd_gain_d))
        strength = dynamics.motor_strength
        return cls(kp * dynamics.kp_scale * strength, kd * dynamics.kd_scale * strength, robot.torque_limit)

    def torque(self, joint_target: Tensor, joint_position: Tensor, joint_velocity: Tensor) -> Tensor:
        """(N, 12) N m, from rad and rad/s."""
        limit = constant(self.limit, joint_position)
        wanted = self.stiffness * (joint_target - joint_position) - self.damping * joint_velocity
        return torch.clamp(wanted, -limit, limit)
