"""What every reader hands on: the frames of a file in the project's own order, units and frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camp.common.errors import ClipError
from camp.motion.exchange.rotations import conjugate, multiply, rotate_inverse, rotation_vector
from camp.robots.go2 import FOOT_NAMES

CONTROL_RATE_HZ = 50.0  # of every clip


@dataclass(frozen=True)
class ImportOptions:
    """What a file does not say, and what to do where it contradicts itself."""

    gait: str  # a key of GAIT_PHASES
    rate_hz: float | None = None  # frames per s, in place of the file's own
    frequency_hz: float | None = None  # stride frequency; measured where None
    command: tuple[float, float, float] | None = None  # vx, vy m/s, wz rad/s held throughout; measured where None
    leg_order: tuple[str, ...] | None = None  # of the file's joints and feet; the format's own where None
    velocity_frame: str = "base"  # of an amp file's root velocities: base or world
    trust_joints: bool = False  # where the file's feet are another robot's
    derive_velocities: bool = False  # from the positions, in place of the file's own
    ground: bool = False  # shift the height so that the lowest feet touch the floor


@dataclass(frozen=True)
class Velocities:
    """Rates of change of N frames."""

    joint: np.ndarray  # (N, 12) rad/s
    base_linear: np.ndarray  # (N, 3) m/s, base frame
    base_angular: np.ndarray  # (N, 3) rad/s, base frame


@dataclass(frozen=True)
class Motion:
    """N equally spaced frames, float64, legs in the order of FOOT_NAMES."""

    rate_hz: float
    base_position: np.ndarray  # (N, 3) m, world
    base_quaternion: np.ndarray  # (N, 4) w first, unit, without jumps of sign
    joint_position: np.ndarray  # (N, 12) rad
    velocities: Velocities | None = None  # the file's own
    foot_position: np.ndarray | None = None  # (N, 4, 3) m, base frame, the file's own
    quaternion_order: str = "w x y z"  # in the file

    def __len__(self) -> int:
        return len(self.base_position)


def by_leg(values: np.ndarray, order: Sequence[str]) -> np.ndarray:
    """Columns (N, 12), three per leg in a file's `order`, in the order of FOOT_NAMES."""
    if sorted(order) != sorted(FOOT_NAMES):
        raise ClipError(f"leg order {','.join(order)}: name each of {','.join(FOOT_NAMES)} once")
    legs = values.reshape(len(values), 4, 3)
    return legs[:, [list(order).index(leg) for leg in FOOT_NAMES]].reshape(len(values), 12)


def derive_velocities(motion: Motion) -> Velocities:
    """Rates of change of the positions, to fourth order; the base's rotation is differentiated on the sphere."""
    step = 1.0 / motion.rate_hz
    quaternion = motion.base_quaternion
    after = np.minimum(np.arange(len(motion)) + 1, len(motion) - 1)
    before = np.maximum(np.arange(len(motion)) - 1, 0)
    turned = rotation_vector(multiply(conjugate(quaternion[before]), quaternion[after]))
    linear = _sharpened(np.gradient(motion.base_position, step, axis=0, edge_order=2))
    return Velocities(
        joint=_sharpened(np.gradient(motion.joint_position, step, axis=0, edge_order=2)),
        base_linear=rotate_inverse(quaternion, linear),
        base_angular=_sharpened(turned / ((after - before) * step)[:, None]),
    )


def _sharpened(central: np.ndarray) -> np.ndarray:
    """Velocities (N, D) of which central differences (N, D) are the mean over three frames by Simpson's rule.

    A central difference alone loses a tenth of a swing leg's speed at 50 Hz. Jacobi's iteration halves the error.
    """
    velocity = central.copy()
    for _ in range(40):
        velocity[1:-1] = (6.0 * central[1:-1] - velocity[:-2] - velocity[2:]) / 4.0
    return velocity
