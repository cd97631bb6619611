"""What passes between a controller and the robot's motors, whatever carries it.

Joint values are in the order of JOINT_NAMES.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from camp.robots.quadruped import NUM_JOINTS

Array = NDArray[np.float32]

REMOTE_BYTES = 40  # of the wireless remote, as LowState carries them


def _zeros() -> Array:
    return np.zeros(NUM_JOINTS, np.float32)


@dataclass(frozen=True)
class Reading:
    """One state of the robot."""

    time_ms: int  # the robot's own clock, which tells one state from the next
    joint_position: Array  # (12,) rad
    joint_velocity: Array  # (12,) rad/s
    attitude: Array  # (4,) unit quaternion w, x, y, z: base frame to world
    angular_velocity: Array  # (3,) rad/s, base frame
    joint_torque: Array = field(default_factory=_zeros)  # (12,) N m
    acceleration: Array = field(default_factory=lambda: np.zeros(3, np.float32))  # (3,) m/s^2, base frame, with gravity
    remote: bytes = bytes(REMOTE_BYTES)
    step: int = 0  # in lockstep: the control step that waits for an answer

    @property
    def gravity(self) -> Array:
        """(3,) unit vector of gravity, base frame."""
        w, x, y, z = self.attitude
        return np.array([2 * (w * y - x * z), -2 * (w * x + y * z), 2 * (x * x + y * y) - 1], np.float32)

    @property
    def tilt(self) -> float:
        """Angle between the trunk's and the world's vertical, rad."""
        return float(np.arccos(np.clip(-self.gravity[2], -1.0, 1.0)))

    @property
    def finite(self) -> bool:
        """Whether every number is one that a controller can use."""
        values = (self.joint_position, self.joint_velocity, self.attitude, self.angular_velocity)
        return all(bool(np.isfinite(value).all()) for value in values) and bool(np.any(self.attitude))


@dataclass(frozen=True)
class Command:
    """What the motors do until the next one: torque + kp (target - q) + kd (velocity - q')."""

    target: Array  # (12,) rad
    kp: Array  # (12,) N m/rad
    kd: Array  # (12,) N m s/rad
    velocity: Array = field(default_factory=_zeros)  # (12,) rad/s
    torque: Array = field(default_factory=_zeros)  # (12,) N m
    step: int = 0  # in lockstep: the state that it answers
