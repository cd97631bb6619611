"""The PD law as a formula: simulators apply it at every physics step, but do not report the torque."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots import go2
from camp.sim.base import Dynamics, Gains


@dataclass
class MotorLaw:
    """The PD law of N robots: strength (kp (target - q) - kd q'), clipped at the joint's torque limit."""

    stiffness: Tensor  # (N, 12) N m/rad
    damping: Tensor  # (N, 12) N m s/rad

    @classmethod
    def of(cls, gains: Gains, dynamics: Dynamics) -> MotorLaw:
        """The law with the nominal gains and the robots' own deviations."""
        strength = dynamics.motor_strength
        kp, kd = (constant(gain, strength) for gain in gains)
        return cls(kp * dynamics.kp_scale * strength, kd * dynamics.kd_scale * strength)

    def torque(self, joint_target: Tensor, joint_position: Tensor, joint_velocity: Tensor) -> Tensor:
        """(N, 12) N m, from rad and rad/s."""
        limit = constant(go2.TORQUE_LIMIT, joint_position)
        wanted = self.stiffness * (joint_target - joint_position) - self.damping * joint_velocity
        return torch.clamp(wanted, -limit, limit)
