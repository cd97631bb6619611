"""What follows from the robots' state: joint torques, the height of feet, the speed at which they slide."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs.measurement import Measurement
from camp.robots import go2
from camp.robots.kinematics import foot_velocity
from camp.sim.base import Dynamics
from camp.sim.parameters import Gains


@dataclass
class MotorLaw:
    """The PD law of N robots: strength (kp (target - q) - kd q'), clipped at the joint's torque limit.

    `camp.sim.base.Simulator` says the same; here it is computed once more because simulators report no torques.
    """

    stiffness: Tensor  # (N, 12) N m/rad
    damping: Tensor  # (N, 12) N m s/rad

    @classmethod
    def of(cls, gains: Gains, dynamics: Dynamics) -> MotorLaw:
        """The law with the nominal gains and the robots' own deviations."""
        kp, kd = (torch.tensor(gain) for gain in gains)
        strength = dynamics.motor_strength
        return cls(kp * dynamics.kp_scale * strength, kd * dynamics.kd_scale * strength)

    def torque(self, joint_target: Tensor, joint_position: Tensor, joint_velocity: Tensor) -> Tensor:
        """(N, T, 12) N m, from rad and rad/s."""
        limit = constant(go2.TORQUE_LIMIT, joint_position)
        wanted = self.stiffness[:, None] * (joint_target - joint_position) - self.damping[:, None] * joint_velocity
        return torch.clamp(wanted, -limit, limit)


def foot_height(measurement: Measurement) -> Tensor:
    """Height of each foot's lowest point above flat ground, (N, 4) m; below 0 where the soft ground gives way."""
    down = measurement.gravity[:, None]
    return measurement.base_position[:, 2:] - (measurement.foot_position * down).sum(dim=-1) - go2.FOOT_RADIUS


def sliding_speed(measurement: Measurement) -> Tensor:
    """Speed over the ground of the point of each foot's sphere that is lowest, (N, 4) m/s.

    A foot that rolls without sliding has 0, although its centre moves.
    """
    omega = measurement.angular_velocity[:, None].expand(-1, go2.NUM_LEGS, -1)  # rad/s, base frame
    centre = measurement.linear_velocity[:, None] + torch.linalg.cross(omega, measurement.foot_position)
    centre = centre + foot_velocity(measurement.joint_position, measurement.joint_velocity)
    hip, thigh, calf = measurement.joint_velocity.unflatten(1, (go2.NUM_LEGS, 3)).unbind(-1)
    angle = measurement.joint_position[:, 0::3]
    # The thigh's and the calf's axes lie along y, turned about x by the hip.
    bend = thigh + calf
    turning = omega + torch.stack([hip, bend * torch.cos(angle), bend * torch.sin(angle)], dim=-1)
    lowest = go2.FOOT_RADIUS * measurement.gravity[:, None].expand(-1, go2.NUM_LEGS, -1)
    velocity = centre + torch.linalg.cross(turning, lowest)
    down = measurement.gravity[:, None]
    return (velocity - (velocity * down).sum(dim=-1, keepdim=True) * down).norm(dim=-1)
