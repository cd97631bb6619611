"""Feet of imported motion: recomputed, compared with the file's own, and which of them stand on the floor."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import numpy as np
import torch

from camp.common.errors import ClipError
from camp.motion.exchange.motion import Motion, Velocities, by_leg
from camp.motion.exchange.rotations import rotate
from camp.robots import kinematics
from camp.robots.go2 import FOOT_NAMES

FOOT_TOLERANCE = 0.01  # m, mean distance of the file's feet from those of its joints
FLOOR_PERCENTILE = 5.0  # of a foot's height over time: where it stands
CONTACT_HEIGHT = 0.015  # m above that
CONTACT_SPEED = 0.6  # m/s of the foot in the world


def feet_of(joint_position: np.ndarray) -> np.ndarray:
    """Foot positions (N, 4, 3) in the base frame, m, of joint positions (N, 12)."""
    return kinematics.foot_position(torch.from_numpy(joint_position)).numpy()


def foot_velocities_of(joint_position: np.ndarray, joint_velocity: np.ndarray) -> np.ndarray:
    """Foot velocities (N, 4, 3) in the base frame, m/s."""
    return kinematics.foot_velocity(torch.from_numpy(joint_position), torch.from_numpy(joint_velocity)).numpy()


def mean_distance(feet: np.ndarray, others: np.ndarray) -> float:
    """Mean distance of feet (N, 4, 3), m."""
    return float(np.linalg.norm(feet - others, axis=-1).mean())


def check_feet(motion: Motion, order: Sequence[str], trust_joints: bool) -> None:
    """Compare the file's feet with those of its joints.

    order: of the file's legs, for the message. Raises ClipError where they are apart; where another order of the
    legs brings them together, that is the reason, whatever `trust_joints` says.
    """
    if motion.foot_position is None:
        return
    distance = mean_distance(feet_of(motion.joint_position), motion.foot_position)
    if distance <= FOOT_TOLERANCE:
        return
    # Under the file's order, leg FOOT_NAMES[k] was read from the columns that `renamed[k]` would have.
    found = {renamed: _distance_if(motion, renamed) for renamed in permutations(FOOT_NAMES)}
    best = min(found, key=lambda renamed: found[renamed])
    if found[best] < distance / 2:
        true_order = ",".join(best[FOOT_NAMES.index(leg)] for leg in order)
        raise ClipError(
            f"feet and joints are {distance:.3f} m apart (mean) with legs read as {','.join(order)}, "
            f"{found[best]:.3f} m with {true_order}; pass --leg-order {true_order}"
        )
    if not trust_joints:
        raise ClipError(
            f"the file's feet are {distance:.3f} m (mean) from those of a Go2 with its joints, at most "
            f"{FOOT_TOLERANCE} m is allowed; if the file was made for another robot, pass --trust-joints to compute "
            "the feet from the joints"
        )


def _distance_if(motion: Motion, renamed: tuple[str, ...]) -> float:
    joints = by_leg(motion.joint_position, renamed)
    assert motion.foot_position is not None
    feet = by_leg(motion.foot_position.reshape(-1, 12), renamed).reshape(-1, 4, 3)
    return mean_distance(feet_of(joints), feet)


def foot_heights(base_position: np.ndarray, base_quaternion: np.ndarray, foot_position: np.ndarray) -> np.ndarray:
    """Heights (N, 4) of the feet's centres in the world, m."""
    return base_position[:, None, 2] + rotate(base_quaternion[:, None], foot_position)[..., 2]


def floor_heights(height: np.ndarray) -> np.ndarray:
    """Height (4,) at which each foot stands, m: retargeted feet do not all stand equally high."""
    return np.percentile(height, FLOOR_PERCENTILE, axis=0)


def estimate_contact(height: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Which feet stand (N, 4): low, and slow. height (N, 4) m, velocity (N, 4, 3) m/s, both in the world."""
    low = height < floor_heights(height) + CONTACT_HEIGHT
    return low & (np.linalg.norm(velocity, axis=-1) < CONTACT_SPEED)


def world_foot_velocity(motion: Motion, velocities: Velocities, foot_position: np.ndarray) -> np.ndarray:
    """Velocities (N, 4, 3) of the feet in the world, m/s; foot_position (N, 4, 3) m, base frame."""
    swing = foot_velocities_of(motion.joint_position, velocities.joint)
    carried = velocities.base_linear[:, None] + np.cross(velocities.base_angular[:, None], foot_position)
    return rotate(motion.base_quaternion[:, None], carried + swing)
