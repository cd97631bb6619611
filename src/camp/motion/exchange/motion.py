"""Input and output of every reader: options, and a file's motion in the project's order, units and frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camp.common.errors import ClipError
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import FREQUENCY_RANGE_HZ
from camp.motion.exchange.rotations import conjugate, multiply, rotate_inverse, rotation_vector
from camp.robots.quadruped import FOOT_NAMES
from camp.robots.robot import Robot

CONTROL_RATE_HZ = 50.0  # of every clip
RATE_RANGE_HZ = (10.0, 1000.0)  # of a motion file
QUATERNION_ORDERS = ("wxyz", "xyzw")
FRAMES = ("base", "world")
FASTEST = (5.0, 5.0, 10.0)  # m/s, m/s, rad/s of a command: beyond what a Go2 does (3.7 m/s by its data sheet)


@dataclass(frozen=True)
class ImportOptions:
    """What a file does not say, and what to do where it contradicts itself."""

    robot: Robot  # whose motion it becomes
    gait: str  # a key of GAIT_PHASES
    rate_hz: float | None = None  # frames per s, in place of the file's own
    frequency_hz: float | None = None  # stride frequency; measured where None
    command: tuple[float, float, float] | None = None  # vx, vy m/s, wz rad/s held throughout; measured where None
    leg_order: tuple[str, ...] | None = None  # of the file's joints; the format's own where None
    foot_order: tuple[str, ...] | None = None  # of the file's feet; the joints' where None
    quaternion_order: str | None = None  # one of QUATERNION_ORDERS; the format's own where None
    velocity_frames: tuple[str, str] = ("base", "base")  # of an amp file's root velocities, linear and angular
    trust_joints: bool = False  # where the file's feet are another robot's
    derive_velocities: bool = False  # from the positions, in place of the file's own
    ground: bool = False  # shift the height so that the lowest feet touch the floor

    def check(self) -> None:
        """Raise ClipError for a value that no motion can have."""
        _check_choice("--gait", self.gait, tuple(GAIT_PHASES))
        if self.rate_hz is not None:
            _check_range("--rate", self.rate_hz, RATE_RANGE_HZ, "frames per s")
        if self.frequency_hz is not None:
            _check_range("--frequency", self.frequency_hz, FREQUENCY_RANGE_HZ, "strides per s")
        for value, fastest in zip(self.command or (), FASTEST, strict=False):
            _check_range("--steady", value, (-fastest, fastest), "m/s, or rad/s for the yaw rate")
        for name, order in (("--leg-order", self.leg_order), ("--foot-order", self.foot_order)):
            if order is not None and sorted(order) != sorted(FOOT_NAMES):
                raise ClipError(f"{name} {','.join(order)}: name each of {','.join(FOOT_NAMES)} once")
        if self.quaternion_order is not None:
            _check_choice("--quaternion-order", self.quaternion_order, QUATERNION_ORDERS)
        for frame in self.velocity_frames:
            _check_choice("--velocity-frame", frame, FRAMES)


def _check_range(name: str, value: float, bounds: tuple[float, float], unit: str) -> None:
    if not bounds[0] <= value <= bounds[1]:
        raise ClipError(f"{name} {value:g}: pass {bounds[0]:g} to {bounds[1]:g} {unit}")


def _check_choice(name: str, value: str, choices: Sequence[str]) -> None:
    if value not in choices:
        raise ClipError(f"{name} {value!r}: pass one of {', '.join(choices)}")


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
    quaternion_order: str = "wxyz"  # in the file
    velocity_frames: tuple[str, str] = ("base", "base")  # of the file's root velocities, linear and angular
    leg_order: tuple[str, ...] = FOOT_NAMES  # as which the file's joints were read
    foot_order: tuple[str, ...] = FOOT_NAMES  # as which its feet were read

    def __len__(self) -> int:
        return len(self.base_position)


def by_leg(values: np.ndarray, order: Sequence[str]) -> np.ndarray:
    """Columns (N, 12), three per leg in a file's `order`, in the order of FOOT_NAMES."""
    legs = values.reshape(len(values), 4, 3)
    return legs[:, [list(order).index(leg) for leg in FOOT_NAMES]].reshape(len(values), 12)


def w_first(quaternion: np.ndarray, order: str) -> np.ndarray:
    """Quaternions (N, 4) of a file, in one of QUATERNION_ORDERS, with w first."""
    return quaternion if order == "wxyz" else quaternion[:, [3, 0, 1, 2]]


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
