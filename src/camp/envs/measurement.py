"""What is derived from the robots' state once per step and read by observations, rewards and terminations."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots.go2 import CONTACT_FORCE
from camp.robots.kinematics import foot_position
from camp.sim.base import RobotState

# The state of the discriminators (paper, Sec. III-C, in its order): entry, size, unit, frame.
AMP_ENTRIES = (
    ("joint_position", 12, "rad", "joint"),
    ("joint_velocity", 12, "rad/s", "joint"),
    ("base_linear_velocity", 3, "m/s", "base"),
    ("base_angular_velocity", 3, "rad/s", "base"),
    ("base_height", 1, "m", "world"),
    ("foot_position", 12, "m", "base"),
)
AMP_STATE_SIZE = sum(size for _, size, _, _ in AMP_ENTRIES)


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
        """s_t of the discriminators, (N, 43), laid out as in AMP_ENTRIES."""
        parts = (
            self.joint_position,
            self.joint_velocity,
            self.linear_velocity,
            self.angular_velocity,
            self.base_position[:, 2:],
            self.foot_position.flatten(1),
        )
        return torch.cat(parts, dim=1)


def measure(state: RobotState) -> Measurement:
    """Derive a ``Measurement`` from the simulator's state."""
    down = constant((0.0, 0.0, -1.0), state.base_position).expand_as(state.base_position)
    return Measurement(
        base_position=state.base_position,
        linear_velocity=rotate_inverse(state.base_quaternion, state.base_linear_velocity),
        angular_velocity=state.base_angular_velocity,
        gravity=rotate_inverse(state.base_quaternion, down),
        joint_position=state.joint_position,
        joint_velocity=state.joint_velocity,
        foot_position=foot_position(state.joint_position),
        foot_contact=state.foot_force.norm(dim=-1) > CONTACT_FORCE,
        body_force=state.body_force.norm(dim=-1),
    )
