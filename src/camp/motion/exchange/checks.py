"""Checks of an imported motion: frame rate, orientation, joint angles, height above the floor."""

from __future__ import annotations

import numpy as np

from camp.common.errors import ClipError
from camp.motion.exchange.feet import CONTACT_HEIGHT, feet_of, floor_heights, foot_heights
from camp.motion.exchange.motion import RATE_RANGE_HZ, Motion
from camp.motion.exchange.rotations import rotate
from camp.robots.quadruped import JOINT_NAMES
from camp.robots.robot import Robot

RANGE_MARGIN = 0.1  # rad by which a joint may pass the robot's range: dogs' legs bend further
LARGEST_TILT = 0.8  # rad, the environment's own limit
# m/s from which it matters whether standing feet move less under another order, and how much less: on the shipped
# clips the wrong order gives 0.21 or more, and at least 1.9 times the right one's.
CLEAR_SLIP, CLEARLY_LESS = 0.1, 0.6
FLOOR_ERROR = 0.03  # m between the lowest feet and the floor


def check_rate(motion: Motion) -> None:
    """Raises ClipError for a frame rate that no motion file has."""
    low, high = RATE_RANGE_HZ
    if not low <= motion.rate_hz <= high:
        raise ClipError(
            f"the frame rate is {motion.rate_hz:g} Hz, expected {low:g} to {high:g}; pass --rate HZ "
            "(an AMP file's 'FrameDuration' is in seconds)"
        )


def check_quaternion_order(robot: Robot, motion: Motion) -> None:
    """Raises ClipError where the file's quaternions are in another order: w first in place of last or last for first.

    Read in the wrong order a robot lies on its back, or faces backward and slips over its standing feet.
    """
    quaternion, declared = motion.base_quaternion, motion.quaternion_order
    shift, other = (1, "xyzw") if declared == "wxyz" else (-1, "wxyz")
    exchanged = np.roll(quaternion, shift, axis=1)
    tilt, other_tilt = _median_tilt(quaternion), _median_tilt(exchanged)
    if tilt > LARGEST_TILT:
        fits = f"in the order {other} it is upright: pass --quaternion-order {other}"
        raise ClipError(
            f"the root quaternion, read as {declared}, tilts the base by {tilt:.2f} rad (median); "
            + (fits if other_tilt < LARGEST_TILT else "z must point up: turn the motion")
        )
    slip, other_slip = _slip(robot, motion, quaternion), _slip(robot, motion, exchanged)
    if slip > CLEAR_SLIP and other_slip < CLEARLY_LESS * slip and other_tilt < LARGEST_TILT:
        raise ClipError(
            f"the root quaternion, read as {declared}, lets standing feet slip at {slip:.2f} m/s (median), in order "
            f"{other} at {other_slip:.2f} m/s: pass --quaternion-order {other}"
        )


def _median_tilt(quaternion: np.ndarray) -> float:
    up = rotate(quaternion, np.array([0.0, 0.0, 1.0]))[:, 2]
    return float(np.arccos(np.clip(np.median(up), -1.0, 1.0)))


def _slip(robot: Robot, motion: Motion, quaternion: np.ndarray) -> float:
    """Median speed in m/s of feet that are down, with the base turned by `quaternion`."""
    local = feet_of(robot, motion.joint_position)
    world = motion.base_position[:, None] + rotate(quaternion[:, None], local)
    down = (world[..., 2] < floor_heights(world[..., 2]) + CONTACT_HEIGHT)[:-1]
    speed = np.linalg.norm(np.diff(world, axis=0), axis=-1) * motion.rate_hz
    return float(np.median(speed[down]))


def check_joint_range(robot: Robot, motion: Motion) -> None:
    """Raises ClipError where a joint is far outside the robot's range: degrees, another order, another robot."""
    lower, upper = robot.joint_lower, robot.joint_upper
    beyond = np.maximum(motion.joint_position - np.array(upper), np.array(lower) - motion.joint_position)
    frame, joint = np.unravel_index(int(beyond.argmax()), beyond.shape)
    if beyond[frame, joint] > RANGE_MARGIN:
        raise ClipError(
            f"{JOINT_NAMES[joint]} is {motion.joint_position[frame, joint]:.2f} rad in frame {frame}, expected "
            f"{lower[joint]:.2f} to {upper[joint]:.2f}; angles must be in rad, in the order hip, thigh, "
            f"calf of each leg (see --leg-order), and the motion made for a {robot.title}"
        )


def check_floor(robot: Robot, motion: Motion) -> float:
    """Height in m by which the lowest feet are above the floor; raises ClipError where they are far from it."""
    height = foot_heights(motion.base_position, motion.base_quaternion, feet_of(robot, motion.joint_position))
    above = float(floor_heights(height).min()) - robot.leg.foot_radius
    if abs(above) > FLOOR_ERROR:
        raise ClipError(
            f"the lowest feet are {above:+.3f} m from the floor (z = 0), at most {FLOOR_ERROR} m is allowed; "
            "pass --ground to shift the motion"
        )
    return above
