"""Leg kinematics in closed form, batched in torch.

All positions are of the foot sphere's centre in the base frame (x forward, y left, z up), in m; legs in the order
of ``FOOT_NAMES``, joints hip, thigh, calf in rad.
"""

from __future__ import annotations

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots.quadruped import NUM_LEGS
from camp.robots.robot import LegGeometry


def _hip_position(leg: LegGeometry, like: Tensor) -> Tensor:
    """Hip joints in the base frame, (4, 3) m."""
    x, y = leg.hip_x, leg.hip_y
    return constant((x, y, 0.0, x, -y, 0.0, -x, y, 0.0, -x, -y, 0.0), like).view(4, 3)


def _thigh_offset(leg: LegGeometry, like: Tensor) -> Tensor:
    """Signed lateral distance from hip joint to thigh joint, (4,) m: left legs positive."""
    offset = leg.hip_offset
    return constant((offset, -offset, offset, -offset), like)


def _leg_plane(leg: LegGeometry, joint: Tensor) -> tuple[Tensor, Tensor]:
    """Foot relative to the thigh joint within the leg's plane: forward and (negative) downward parts, (..., 4) m."""
    thigh, knee = joint[..., 1], joint[..., 1] + joint[..., 2] + leg.shank_angle
    forward = -leg.thigh_length * torch.sin(thigh) - leg.shank * torch.sin(knee)
    down = -leg.thigh_length * torch.cos(thigh) - leg.shank * torch.cos(knee)
    return forward, down


def foot_position(leg: LegGeometry, joint_position: Tensor) -> Tensor:
    """Forward kinematics: joint positions (..., 12) to foot positions (..., 4, 3)."""
    joint = joint_position.unflatten(-1, (NUM_LEGS, 3))
    forward, down = _leg_plane(leg, joint)
    sin, cos = torch.sin(joint[..., 0]), torch.cos(joint[..., 0])
    offset = _thigh_offset(leg, joint)
    from_hip = torch.stack([forward, cos * offset - sin * down, sin * offset + cos * down], dim=-1)
    return from_hip + _hip_position(leg, joint)


def foot_jacobian(leg: LegGeometry, joint_position: Tensor) -> Tensor:
    """d foot position / d joint position of each leg: (..., 12) to (..., 4, 3, 3), rows x, y, z."""
    joint = joint_position.unflatten(-1, (NUM_LEGS, 3))
    forward, down = _leg_plane(leg, joint)
    sin, cos = torch.sin(joint[..., 0]), torch.cos(joint[..., 0])
    offset = _thigh_offset(leg, joint)
    knee = joint[..., 1] + joint[..., 2] + leg.shank_angle
    calf_forward, calf_down = -leg.shank * torch.cos(knee), leg.shank * torch.sin(knee)
    zero = torch.zeros_like(forward)
    hip = torch.stack([zero, -sin * offset - cos * down, cos * offset - sin * down], dim=-1)
    thigh = torch.stack([down, sin * forward, -cos * forward], dim=-1)
    calf = torch.stack([calf_forward, -sin * calf_down, cos * calf_down], dim=-1)
    return torch.stack([hip, thigh, calf], dim=-1)


def foot_velocity(leg: LegGeometry, joint_position: Tensor, joint_velocity: Tensor) -> Tensor:
    """d foot position / dt in the base frame: (..., 12) and (..., 12) rad/s to (..., 4, 3) m/s."""
    rate = joint_velocity.unflatten(-1, (NUM_LEGS, 3))
    return (foot_jacobian(leg, joint_position) @ rate.unsqueeze(-1)).squeeze(-1)
