"""What follows from the robots' state: joint torques."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots import go2
from camp.robots.config import RobotConfig
from camp.sim.base import Dynamics


@dataclass
class MotorLaw:
    """The PD law of N robots: strength (kp (target - q) - kd q'), clipped at the joint's torque limit.

    `camp.sim.base.Simulator` says the same; here it is computed once more because simulators report no torques.
    """

    stiffness: Tensor  # (N, 12) N m/rad
    damping: Tensor  # (N, 12) N m s/rad

    @classmethod
    def of(cls, robot: RobotConfig, dynamics: Dynamics) -> MotorLaw:
        """The law with the nominal gains of conf/robot and the robots' own deviations."""
        kp, kd = (torch.tensor(list(gains) * go2.NUM_LEGS) for gains in (robot.kp, robot.kd))
        strength = dynamics.motor_strength
        return cls(kp * dynamics.kp_scale * strength, kd * dynamics.kd_scale * strength)

    def torque(self, joint_target: Tensor, joint_position: Tensor, joint_velocity: Tensor) -> Tensor:
        """(N, 12) N m, from rad and rad/s."""
        limit = constant(go2.TORQUE_LIMIT, joint_position)
        wanted = self.stiffness * (joint_target - joint_position) - self.damping * joint_velocity
        return torch.clamp(wanted, -limit, limit)
