"""Is an imported motion what its file says: rate, velocities, joint angles, floor?"""

from __future__ import annotations

import numpy as np

from camp.common.errors import ClipError
from camp.motion.exchange.feet import CONTACT_HEIGHT, feet_of, floor_heights, foot_heights
from camp.motion.exchange.motion import Motion, Velocities, derive_velocities
from camp.motion.exchange.rotations import rotate, rotate_inverse
from camp.robots.go2 import FOOT_RADIUS, JOINT_LOWER, JOINT_NAMES, JOINT_UPPER

RATE_RANGE_HZ = (10.0, 1000.0)
RATE_ERROR = 0.15  # by which positions may change faster or slower than the joint velocities say
# Velocities against differences of positions, root mean square as a fraction of the velocities' own (plus a floor).
# Mocap is noisy and every file differentiates in its own way; a wrong frame or column gives 1 or more.
MISMATCH = 0.4
CLEAR_MISMATCH = 0.1  # from which it matters whether another frame fits twice as well
EQUAL = 0.02  # of their size by which velocities may miss plain differences and still be such (rounding)
JOINT_FLOOR, LINEAR_FLOOR, ANGULAR_FLOOR = 0.5, 0.1, 0.3  # rad/s, m/s, rad/s
RANGE_MARGIN = 0.1  # rad by which a joint may pass the Go2's range: dogs' legs bend further
LARGEST_TILT = 0.8  # rad, the environment's own limit
CLEAR_SLIP = 0.2  # m/s from which it matters whether feet slip less under another order
FLOOR_ERROR = 0.03  # m between the lowest feet and the floor


def check_rate(motion: Motion) -> None:
    """Raises ClipError for a frame rate that no motion file has."""
    low, high = RATE_RANGE_HZ
    if not low <= motion.rate_hz <= high:
        raise ClipError(
            f"the frame rate is {motion.rate_hz:g} Hz, expected {low:g} to {high:g}; pass --rate HZ "
            "(an AMP file's 'FrameDuration' is in seconds)"
        )


def check_quaternion_order(motion: Motion) -> None:
    """Raises ClipError where the file's quaternions are in another order: w first in place of last or last for first.

    Read in the wrong order a robot lies on its back, or faces backward and slips over its standing feet.
    """
    quaternion, declared = motion.base_quaternion, motion.quaternion_order
    shift, other = (1, "x y z w") if declared == "w x y z" else (-1, "w x y z")
    exchanged = np.roll(quaternion, shift, axis=1)
    tilt, other_tilt = _median_tilt(quaternion), _median_tilt(exchanged)
    if tilt > LARGEST_TILT:
        fits = f"in the order {other} it is upright: reorder the columns"
        raise ClipError(
            f"the root quaternion, read as {declared}, tilts the base by {tilt:.2f} rad (median); "
            + (fits if other_tilt < LARGEST_TILT else "z must point up: turn the motion")
        )
    slip, other_slip = _slip(motion, quaternion), _slip(motion, exchanged)
    if slip > CLEAR_SLIP and other_slip < slip / 3 and other_tilt < LARGEST_TILT:
        raise ClipError(
            f"the root quaternion, read as {declared}, lets standing feet slip at {slip:.2f} m/s (median), in order "
            f"{other} at {other_slip:.2f} m/s: reorder the columns"
        )


def _median_tilt(quaternion: np.ndarray) -> float:
    up = rotate(quaternion, np.array([0.0, 0.0, 1.0]))[:, 2]
    return float(np.arccos(np.clip(np.median(up), -1.0, 1.0)))


def _slip(motion: Motion, quaternion: np.ndarray) -> float:
    """Median horizontal speed in m/s of feet that are down, with the base turned by `quaternion`."""
    local = feet_of(motion.joint_position)
    world = motion.base_position[:, None] + rotate(quaternion[:, None], local)
    down = (world[..., 2] < floor_heights(world[..., 2]) + CONTACT_HEIGHT)[:-1]
    speed = np.linalg.norm(np.diff(world[..., :2], axis=0), axis=-1) * motion.rate_hz
    return float(np.median(speed[down]))


def check_velocities(motion: Motion) -> None:
    """Compare the file's velocities with its positions; raises ClipError for another rate or frame."""
    if motion.velocities is None:
        return
    derived = derive_velocities(motion)
    _check_scale(motion, derived)
    given = motion.velocities
    _check_fit("joint velocities", given.joint, derived.joint, JOINT_FLOOR)
    _check_frame(motion, "root linear velocity", (given.base_linear, derived.base_linear), LINEAR_FLOOR)
    _check_frame(motion, "root angular velocity", (given.base_angular, derived.base_angular), ANGULAR_FLOOR)


def _check_fit(name: str, given: np.ndarray, derived: np.ndarray, floor: float) -> None:
    mismatch = _mismatch(given, derived, floor)
    if mismatch > MISMATCH:
        raise ClipError(
            f"the {name} misses the change of the positions by {mismatch:.2f} of its size, at most {MISMATCH} is "
            "allowed; check the columns, or pass --derive-velocities to compute it from the positions"
        )


def _check_frame(motion: Motion, name: str, pair: tuple[np.ndarray, np.ndarray], floor: float) -> None:
    """pair: the file's and the derived velocity (N, 3), m/s or rad/s, both in the base frame."""
    given, derived = pair
    mismatch = _mismatch(given, derived, floor)
    if mismatch > CLEAR_MISMATCH:
        turned = {"world": rotate_inverse(motion.base_quaternion, given), "base": rotate(motion.base_quaternion, given)}
        for frame, other in turned.items():
            found = _mismatch(other, derived, floor)
            if found < mismatch / 2:
                raise ClipError(
                    f"the {name} misses the change of the positions by {mismatch:.2f} of its size, but by {found:.2f} "
                    f"if taken in the {frame} frame; pass --velocity-frame {frame}"
                )
    _check_fit(name, given, derived, floor)


def _check_scale(motion: Motion, derived: Velocities) -> None:
    """Positions that change r times as fast as the joint velocities say were sampled at another rate."""
    assert motion.velocities is not None
    given = _smooth(motion.velocities.joint)
    size = float((given**2).sum())
    if np.sqrt(size / given.size) < JOINT_FLOOR:
        return  # stands still
    ratio = float((given * _smooth(derived.joint)).sum()) / size
    if abs(ratio - 1.0) <= RATE_ERROR:
        return
    fitting = f"pass the rate the motion was sampled at (--rate, about {motion.rate_hz / ratio:.0f} Hz), or "
    raise ClipError(
        f"at {motion.rate_hz:g} Hz the joints move {ratio:.2f} times as fast as the file's joint velocities say; "
        f"{fitting if ratio > RATE_ERROR else ''}pass --derive-velocities if the velocities are wrong"
    )


def _mismatch(given: np.ndarray, derived: np.ndarray, floor: float) -> float:
    size = np.sqrt(np.mean(given**2)) + floor
    return float(np.sqrt(np.mean((_smooth(given) - _smooth(derived)) ** 2)) / size)


def _smooth(values: np.ndarray) -> np.ndarray:
    """Mean over three frames (N - 2, ...): forward, central and backward differences come close to each other."""
    return (values[:-2] + values[1:-1] + values[2:]) / 3


def are_differences(motion: Motion) -> bool:
    """Whether the file's velocities are mere differences to the next or the previous frame, half a frame off."""
    if motion.velocities is None:
        return False
    given = motion.velocities.joint
    difference = np.diff(motion.joint_position, axis=0) * motion.rate_hz
    errors = [np.sqrt(np.mean((difference - velocity) ** 2)) for velocity in (given[:-1], given[1:])]
    return bool(min(errors) < EQUAL * np.sqrt(np.mean(given**2)))


def check_joint_range(motion: Motion) -> None:
    """Raises ClipError where a joint is far outside the Go2's range: degrees, another order, another robot."""
    beyond = np.maximum(motion.joint_position - np.array(JOINT_UPPER), np.array(JOINT_LOWER) - motion.joint_position)
    frame, joint = np.unravel_index(int(beyond.argmax()), beyond.shape)
    if beyond[frame, joint] > RANGE_MARGIN:
        raise ClipError(
            f"{JOINT_NAMES[joint]} is {motion.joint_position[frame, joint]:.2f} rad in frame {frame}, expected "
            f"{JOINT_LOWER[joint]:.2f} to {JOINT_UPPER[joint]:.2f}; angles must be in rad, in the order hip, thigh, "
            "calf of each leg (see --leg-order)"
        )


def check_floor(motion: Motion) -> float:
    """Height in m by which the lowest feet are above the floor; raises ClipError where they are far from it."""
    height = foot_heights(motion.base_position, motion.base_quaternion, feet_of(motion.joint_position))
    above = float(floor_heights(height).min()) - FOOT_RADIUS
    if abs(above) > FLOOR_ERROR:
        raise ClipError(
            f"the lowest feet are {above:+.3f} m from the floor (z = 0), at most {FLOOR_ERROR} m is allowed; "
            "pass --ground to shift the motion"
        )
    return above
