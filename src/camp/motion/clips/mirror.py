"""Mirroring a motion left to right: the robot is symmetric, so the image of a valid clip is a valid clip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camp.motion.clips.clip import Clip

_OTHER_LEG = [1, 0, 3, 2]  # FL <-> FR, RL <-> RR
_VECTOR = np.array([1, -1, 1], dtype=np.float32)  # of lengths and velocities: y turns round
_ROTATION = np.array([-1, 1, -1], dtype=np.float32)  # of angular velocities: about x and z turn round
_QUATERNION = np.array([1, -1, 1, -1], dtype=np.float32)  # w, x, y, z
_JOINTS = np.array([-1, 1, 1], dtype=np.float32)  # hip, thigh, calf: the hips turn about x
_TWIST = np.array([1, -1, -1], dtype=np.float32)  # vx, vy, yaw rate


def mirrored(clip: Clip) -> Clip:
    """The clip as a mirror in the x-z plane shows it; mirroring twice gives the clip back."""
    return replace(
        clip,
        command=clip.command * _TWIST,
        base_position=clip.base_position * _VECTOR,
        base_quaternion=clip.base_quaternion * _QUATERNION,
        joint_position=_joints(clip.joint_position),
        joint_velocity=_joints(clip.joint_velocity),
        base_linear_velocity=clip.base_linear_velocity * _VECTOR,
        base_angular_velocity=clip.base_angular_velocity * _ROTATION,
        foot_position=clip.foot_position[:, _OTHER_LEG] * _VECTOR,
        foot_velocity=clip.foot_velocity[:, _OTHER_LEG] * _VECTOR,
        foot_contact=clip.foot_contact[:, _OTHER_LEG],
        joint_target=_joints(clip.joint_target),
        joint_target_applied=_joints(clip.joint_target_applied),
        joint_torque=_joints(clip.joint_torque),
    )


def _joints(values: np.ndarray) -> np.ndarray:
    """Rows of 12 joint values on the other side."""
    return (values.reshape(-1, 4, 3)[:, _OTHER_LEG] * _JOINTS).reshape(-1, 12)
