"""Mirroring a motion left to right: the robot is symmetric, so the image of a valid clip is a valid clip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camp.motion.clips.clip import Clip
from camp.robots.mirror import FEET, JOINTS, QUATERNION, ROTATION, TWIST, VECTOR, Mirror


def with_images(clips: Sequence[Clip]) -> list[Clip]:
    """Every clip, followed by its mirror image."""
    return [one for clip in clips for one in (clip, mirrored(clip))]


def mirrored(clip: Clip) -> Clip:
    """The clip as a mirror in the x-z plane shows it; mirroring twice gives the clip back."""
    return replace(
        clip,
        command=_image(clip.command, TWIST),
        base_position=_image(clip.base_position, VECTOR),
        base_quaternion=_image(clip.base_quaternion, QUATERNION),
        joint_position=_image(clip.joint_position, JOINTS),
        joint_velocity=_image(clip.joint_velocity, JOINTS),
        base_linear_velocity=_image(clip.base_linear_velocity, VECTOR),
        base_angular_velocity=_image(clip.base_angular_velocity, ROTATION),
        foot_position=_image(clip.foot_position[:, FEET.order], VECTOR),
        foot_velocity=_image(clip.foot_velocity[:, FEET.order], VECTOR),
        foot_contact=clip.foot_contact[:, FEET.order],
        foot_stance=None if clip.foot_stance is None else clip.foot_stance[:, FEET.order],
        joint_target=_image(clip.joint_target, JOINTS),
        joint_target_applied=_image(clip.joint_target_applied, JOINTS),
        joint_torque=_image(clip.joint_torque, JOINTS),
    )


def _image(values: np.ndarray, mirror: Mirror) -> np.ndarray:
    """(..., size) in the mirror, of the same type."""
    return values[..., mirror.order] * np.asarray(mirror.sign, dtype=values.dtype)
