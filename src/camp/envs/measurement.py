"""Quantities derived from the robots' state once per step, for observations, rewards and terminations."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots.amp_state import amp_parts
from camp.robots.kinematics import foot_position, foot_velocity
from camp.robots.quadruped import CONTACT_FORCE, NUM_LEGS
from camp.robots.robot import Robot
from camp.sim.base import RobotState


def rotate(quaternion: Tensor, vector: Tensor) -> Tensor:
    """Rotate vectors (..., 3) by unit quaternions (..., 4), w first: base frame to world frame."""
    w, axis = quaternion[..., :1], quaternion[..., 1:]
    twice = 2.0 * torch.linalg.cross(axis, vector)
    return vector + w * twice + torch.linalg.cross(axis, twice)


def rotate_inverse(quaternion: Tensor, vector: Tensor) -> Tensor:
    """Rotate vectors (..., 3) by the inverse of unit quaternions (..., 4): world frame to base frame."""
    return rotate(quaternion * constant((1.0, -1.0, -1.0, -1.0), quaternion), vector)


@dataclass
class Measurement:
    """N robots at one moment, SI units; "base frame" moves with the trunk."""

    base_position: Tensor  # (N, 3) m, world frame
    linear_velocity: Tensor  # (N, 3) m/s, base frame
    angular_velocity: Tensor  # (N, 3) rad/s, base frame
    gravity: Tensor  # (N, 3) unit vector of gravity, base frame
    joint_position: Tensor  # (N, 12) rad
    joint_velocity: Tensor  # (N, 12) rad/s
    foot_position: Tensor  # (N, 4, 3) m, base frame
    foot_contact: Tensor  # (N, 4) bool
    body_force: Tensor  # (N, 5) N, magnitude on base and thighs

    def velocity(self) -> Tensor:
        """What commands ask for, (N, 3): vx, vy in m/s and yaw rate in rad/s, base frame."""
        return torch.cat([self.linear_velocity[:, :2], self.angular_velocity[:, 2:]], dim=1)

    def amp_state(self) -> Tensor:
        """The paper's state s_t of the discriminators, (N, 43), laid out as in `camp.robots.amp_state`."""
        values = {
            "joint_position": self.joint_position,
            "joint_velocity": self.joint_velocity,
            "base_linear_velocity": self.linear_velocity,
            "base_angular_velocity": self.angular_velocity,
            "base_height": self.base_position[:, 2:],
            "foot_position": self.foot_position.flatten(1),
        }
        return torch.cat(amp_parts(values), dim=1)


def measure(robot: Robot, state: RobotState) -> Measurement:
    """Derive a ``Measurement`` of N copies of a robot from the simulator's state."""
    down = constant((0.0, 0.0, -1.0), state.base_position).expand_as(state.base_position)
    return Measurement(
        base_position=state.base_position,
        linear_velocity=rotate_inverse(state.base_quaternion, state.base_linear_velocity),
        angular_velocity=state.base_angular_velocity,
        gravity=rotate_inverse(state.base_quaternion, down),
        joint_position=state.joint_position,
        joint_velocity=state.joint_velocity,
        foot_position=foot_position(robot.leg, state.joint_position),
        foot_contact=state.foot_force.norm(dim=-1) > CONTACT_FORCE,
        body_force=state.body_force.norm(dim=-1),
    )


def sliding_speed(robot: Robot, measurement: Measurement) -> Tensor:
    """Speed over the ground of the point of each foot's sphere that is lowest, (N, 4) m/s.

    A foot that rolls without sliding has 0, although its centre moves.
    """
    omega = measurement.angular_velocity[:, None].expand(-1, NUM_LEGS, -1)  # rad/s, base frame
    centre = measurement.linear_velocity[:, None] + torch.linalg.cross(omega, measurement.foot_position)
    centre = centre + foot_velocity(robot.leg, measurement.joint_position, measurement.joint_velocity)
    hip, thigh, calf = measurement.joint_velocity.unflatten(1, (NUM_LEGS, 3)).unbind(-1)
    angle = measurement.joint_position[:, 0::3]
    # The thigh's and the calf's axes lie along y, turned about x by the hip.
    bend = thigh + calf
    turning = omega + torch.stack([hip, bend * torch.cos(angle), bend * torch.sin(angle)], dim=-1)
    lowest = robot.leg.foot_radius * measurement.gravity[:, None].expand(-1, NUM_LEGS, -1)
    velocity = centre + torch.linalg.cross(turning, lowest)
    down = measurement.gravity[:, None]
    return (velocity - (velocity * down).sum(dim=-1, keepdim=True) * down).norm(dim=-1)


def foot_height(robot: Robot, measurement: Measurement) -> Tensor:
    """Height of each foot's lowest point above flat ground, (N, 4) m; below 0 where the soft ground gives way."""
    down = measurement.gravity[:, None]
    below = (measurement.foot_position * down).sum(dim=-1) + robot.leg.foot_radius
    return measurement.base_position[:, 2:] - below
