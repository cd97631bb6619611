"""Feet of imported motion: recomputed, compared with the file's own, and which of them stand on the floor."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import numpy as np
import torch

from camp.common.errors import ClipError
from camp.motion.exchange.motion import Motion, Velocities
from camp.motion.exchange.rotations import rotate
from camp.robots import kinematics
from camp.robots.quadruped import FOOT_NAMES
from camp.robots.robot import Robot

FOOT_TOLERANCE = 0.01  # m, mean distance of the file's feet from those of its joints
CLEARLY_NEARER = 0.75  # of the distance, from which another order of the legs is the right one
ROUNDING = 0.001  # m, below which no other order of the legs is looked for
FLOOR_PERCENTILE = 5.0  # of a foot's height over time: where it stands
CONTACT_HEIGHT = 0.015  # m above that
CONTACT_SPEED = 0.6  # m/s of the foot in the world


def feet_of(robot: Robot, joint_position: np.ndarray) -> np.ndarray:
    """Foot positions (N, 4, 3) in the base frame, m, of joint positions (N, 12)."""
    return kinematics.foot_position(robot.leg, torch.from_numpy(joint_position)).numpy()


def foot_velocities_of(robot: Robot, joint_position: np.ndarray, joint_velocity: np.ndarray) -> np.ndarray:
    """Foot velocities (N, 4, 3) in the base frame, m/s."""
    joints = (torch.from_numpy(joint_position), torch.from_numpy(joint_velocity))
    return kinematics.foot_velocity(robot.leg, *joints).numpy()


def mean_distance(feet: np.ndarray, others: np.ndarray) -> float:
    """Mean distance of feet (N, 4, 3), m."""
    return float(np.linalg.norm(feet - others, axis=-1).mean())


def check_feet(robot: Robot, motion: Motion, trust_joints: bool) -> None:
    """Compare the file's feet with those of its joints.

    Raises ClipError where they are apart; where other orders of the joints' and the feet's legs bring them together,
    that is the reason, whatever `trust_joints` says.
    """
    if motion.foot_position is None:
        return
    apart = _distances(robot, motion)
    distance = float(apart[range(4), range(4), range(4)].mean())
    if distance <= ROUNDING:
        return
    found, legs, feet = _best_orders(apart)
    if found < CLEARLY_NEARER * distance:
        leg_order = _renamed(motion.leg_order, legs)
        foot_order = _renamed(motion.foot_order, feet)
        options = f"--leg-order {','.join(leg_order)}"
        if foot_order != leg_order:
            options += f" --foot-order {','.join(foot_order)}"
        raise ClipError(
            f"feet and joints are {distance:.3f} m apart (mean) with joints read as {','.join(motion.leg_order)} and "
            f"feet as {','.join(motion.foot_order)}, {found:.3f} m with joints {','.join(leg_order)} and feet "
            f"{','.join(foot_order)}; pass {options}"
        )
    if distance > FOOT_TOLERANCE and not trust_joints:
        raise ClipError(
            f"the file's feet are {distance:.3f} m (mean) from those of a {robot.title} with its joints, at most "
            f"{FOOT_TOLERANCE} m is allowed; if the file was made for another robot, pass --trust-joints to compute "
            "the feet from the joints"
        )


def _distances(robot: Robot, motion: Motion) -> np.ndarray:
    """Mean distance (4, 4, 4), m, at leg L between the foot that the joints of leg A would have there and foot B."""
    assert motion.foot_position is not None
    joints = motion.joint_position.reshape(-1, 4, 3)
    apart = np.empty((4, 4, 4))
    for source in range(4):
        feet = feet_of(robot, np.repeat(joints[:, source : source + 1], 4, axis=1).reshape(-1, 12))
        gap = np.linalg.norm(feet[:, :, None] - motion.foot_position[:, None], axis=-1)  # (N, leg, foot)
        apart[:, source] = gap.mean(axis=0)
    return apart


def _best_orders(apart: np.ndarray) -> tuple[float, tuple[int, ...], tuple[int, ...]]:
    """The smallest mean distance, m, and the legs whose joints and whose feet belong to FL, FR, RL, RR with it."""
    near, orders = apart.tolist(), list(permutations(range(4)))
    found = {
        (legs, feet): sum(near[leg][legs[leg]][feet[leg]] for leg in range(4)) / 4 for legs in orders for feet in orders
    }
    legs, feet = min(found, key=lambda pair: found[pair])
    return found[legs, feet], legs, feet


def _renamed(order: Sequence[str], sources: Sequence[int]) -> tuple[str, ...]:
    """A file's order of legs, once leg FOOT_NAMES[k] is what was read as FOOT_NAMES[sources[k]]."""
    true_name = {FOOT_NAMES[source]: FOOT_NAMES[leg] for leg, source in enumerate(sources)}
    return tuple(true_name[leg] for leg in order)


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


def world_foot_velocity(robot: Robot, motion: Motion, velocities: Velocities, foot_position: np.ndarray) -> np.ndarray:
    """Velocities (N, 4, 3) of the feet in the world, m/s; foot_position (N, 4, 3) m, base frame."""
    swing = foot_velocities_of(robot, motion.joint_position, velocities.joint)
    carried = velocities.base_linear[:, None] + np.cross(velocities.base_angular[:, None], foot_position)
    return rotate(motion.base_quaternion[:, None], carried + swing)
