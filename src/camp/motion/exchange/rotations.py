"""Quaternions in numpy, (..., 4) with w first, for reading and resampling motion."""

from __future__ import annotations

import numpy as np


def multiply(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Quaternion product (..., 4): `right` is applied first."""
    vector = left[..., :1] * right[..., 1:] + right[..., :1] * left[..., 1:] + np.cross(left[..., 1:], right[..., 1:])
    scalar = left[..., :1] * right[..., :1] - (left[..., 1:] * right[..., 1:]).sum(-1, keepdims=True)
    return np.concatenate([scalar, vector], axis=-1)


def conjugate(quaternion: np.ndarray) -> np.ndarray:
    """The inverse rotation (..., 4) of a unit quaternion."""
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) from the base frame to the world."""
    axis, scalar = quaternion[..., 1:], quaternion[..., :1]
    turned = 2.0 * np.cross(axis, vector)
    return vector + scalar * turned + np.cross(axis, turned)


def rotate_inverse(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) from the world to the base frame."""
    return rotate(conjugate(quaternion), vector)


def rotation_vector(quaternion: np.ndarray) -> np.ndarray:
    """Axis times angle (..., 3), rad, the short way round."""
    quaternion = np.where(quaternion[..., :1] < 0.0, -quaternion, quaternion)
    sine = np.linalg.norm(quaternion[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, quaternion[..., :1])
    return quaternion[..., 1:] * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)


def continuous(quaternion: np.ndarray) -> np.ndarray:
    """Unit quaternions (N, 4) whose signs do not jump from one frame to the next."""
    unit = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    flips = np.where((unit[1:] * unit[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)
    return unit * np.cumprod(np.concatenate([[1.0], flips]))[:, None]


def slerp(start: np.ndarray, end: np.ndarray, fraction: np.ndarray) -> np.ndarray:
    """Spherical interpolation (M, 4) between continuous quaternions (M, 4), fraction (M, 1) in [0, 1]."""
    angle = np.arccos(np.clip((start * end).sum(axis=1, keepdims=True), -1.0, 1.0))
    sine = np.sin(angle)
    small = sine < 1e-6  # a chord is as good as the arc
    divisor = np.where(small, 1.0, sine)
    before = np.where(small, 1.0 - fraction, np.sin((1.0 - fraction) * angle) / divisor)
    after = np.where(small, fraction, np.sin(fraction * angle) / divisor)
    mixed = before * start + after * end
    return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)


def yaw(quaternion: np.ndarray) -> np.ndarray:
    """Heading (...,) in rad."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    return np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
