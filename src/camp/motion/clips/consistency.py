"""Consistency checks of a clip that need no simulation and are applied whenever a clip is loaded.

A file whose arrays were mixed up on the way (quaternion order, legs, frame rate, frames of different time) does
not move as its velocities say, or has its feet where its joints cannot put them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from camp.motion.clips.clip import Clip
from camp.robots import kinematics
from camp.robots.robot import Robot

LOWEST_BASE = 0.52  # of the standing height
LARGEST_TILT = 0.8  # rad, the environment's own limit
# Velocities against differences of positions, root mean square over the clip as a fraction of the velocities'
# own (plus a floor): 20 ms apart, impacts fall between two rows.
CONSISTENCY = 0.25
RATE_ERROR = 0.08  # by which the base moves faster or slower than its velocity says
_LEAST_SPEED = 0.02  # m/s, root mean square, of a base that tells the rate
FOOT_ERROR = 0.01  # m, foot positions against the joints' forward kinematics
_ROUNDING = 1e-5  # of float32


@dataclass(frozen=True)
class ClipCheck:
    """One criterion: the measured value must be `bound` ("<=" or ">=") the limit. NaN never passes."""

    name: str
    value: float
    limit: float
    bound: str = "<="

    @property
    def passed(self) -> bool:
        """Whether the criterion holds."""
        return self.value <= self.limit if self.bound == "<=" else self.value >= self.limit

    def __str__(self) -> str:
        return f"{self.name} {self.value:.3g} is not {self.bound} {self.limit:.3g}"


def at_most(name: str, value: float, limit: float) -> ClipCheck:
    """The value may not exceed the limit."""
    return ClipCheck(name, float(value), limit, "<=")


def at_least(name: str, value: float, limit: float) -> ClipCheck:
    """The value may not fall below the limit."""
    return ClipCheck(name, float(value), limit, ">=")


def guard_checks(robot: Robot, clip: Clip) -> list[ClipCheck]:
    """Posture, torques, velocities against positions, feet against joints: some milliseconds a clip."""
    return [
        *_posture(robot, clip),
        *_velocities(clip),
        at_most("rate error", abs(fitting_period(clip) / clip.dt - 1.0), RATE_ERROR),
        at_most("foot off its leg (m)", foot_error(robot, clip), FOOT_ERROR),
    ]


def rotation_matrix(quaternion: np.ndarray) -> np.ndarray:
    """Quaternions (..., 4), w first, to matrices (..., 3, 3)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, dtype=np.float64), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def foot_error(robot: Robot, clip: Clip) -> float:
    """Largest distance in m between a foot's position and where the joints put it."""
    computed = kinematics.foot_position(robot.leg, torch.from_numpy(np.asarray(clip.joint_position, dtype=np.float64)))
    return float(np.linalg.norm(computed.numpy() - clip.foot_position, axis=-1).max())


def foot_height(robot: Robot, clip: Clip) -> np.ndarray:
    """Height (T, 4) of the feet's lowest points above the floor in m."""
    up = rotation_matrix(clip.base_quaternion)[:, 2]
    return np.einsum("tj,tlj->tl", up, clip.foot_position) + clip.base_position[:, 2:] - robot.leg.foot_radius


def fitting_period(clip: Clip) -> float:
    """Time between rows in s that makes the base move as its velocity says; `dt` where it hardly moves."""
    velocity = np.einsum("tij,tj->ti", rotation_matrix(clip.base_quaternion), clip.base_linear_velocity)
    velocity = (velocity[1:] + velocity[:-1]) / 2
    size = float(np.sum(velocity**2))
    if size < len(velocity) * _LEAST_SPEED**2:
        return clip.dt
    return float(np.sum(np.diff(clip.base_position, axis=0) * velocity)) / size


def _posture(robot: Robot, clip: Clip) -> list[ClipCheck]:
    tilt = np.arccos(np.clip(rotation_matrix(clip.base_quaternion)[:, 2, 2], -1.0, 1.0))
    torque = np.abs(clip.joint_torque / np.array(robot.torque_limit)).max()
    return [
        at_least("lowest base (m)", clip.base_position[:, 2].min(), round(LOWEST_BASE * robot.standing_height, 2)),
        at_most("largest tilt (rad)", tilt.max(), LARGEST_TILT),
        at_most("torque / limit", torque, 1.0 + _ROUNDING),
    ]


def _velocities(clip: Clip) -> list[ClipCheck]:
    rotation = rotation_matrix(clip.base_quaternion)
    world = np.einsum("tij,tj->ti", rotation, clip.base_linear_velocity)
    relative = np.swapaxes(rotation[:-1], 1, 2) @ rotation[1:]
    skew = relative - np.swapaxes(relative, 1, 2)
    turned = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1) / 2  # rotation vector of small angles
    moved = {
        "base velocity": (np.diff(clip.base_position, axis=0), world, 0.1),
        "base turning": (turned, clip.base_angular_velocity, 0.2),
        "joint velocity": (np.diff(clip.joint_position, axis=0), clip.joint_velocity, 0.5),
        "foot velocity": (np.diff(clip.foot_position, axis=0), clip.foot_velocity, 0.1),
    }
    return [
        at_most(f"{name} mismatch", _mismatch(change / clip.dt, velocity, floor), CONSISTENCY)
        for name, (change, velocity, floor) in moved.items()
    ]


def _mismatch(difference: np.ndarray, velocity: np.ndarray, floor: float) -> float:
    """Distance of differences (T - 1, ...) from the mean velocities, as a fraction of the velocities' size."""
    middle = (velocity[1:] + velocity[:-1]) / 2
    return float(np.sqrt(np.mean((difference - middle) ** 2)) / (np.sqrt(np.mean(velocity**2)) + floor))
