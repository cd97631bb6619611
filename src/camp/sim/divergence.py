"""What a robot can physically do: a state beyond it is a simulation that diverged, whatever the backend.

The bounds are far outside of anything that a healthy simulation shows. Random joint targets with a standard deviation
of up to 125 rad, under the whole of Table I, with pushes and without an end of episodes, reached 4.9 m/s, 69 rad/s of
the trunk, 160 rad/s of a joint, 1.4 rad beyond a joint's stop, a height of 1.2 m and 6.5 kN (256 Go2s, 18 s each).
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.robots.quadruped import FOOT_NAMES, GRAVITY, JOINT_NAMES
from camp.robots.robot import Robot
from camp.sim.base import RobotState

JOINT_SPEED = 20.0  # times the joint's own limit, which the motors' torque alone does not enforce
JOINT_EXCESS = math.pi  # rad beyond a joint's stop, which is soft
TRUNK_SPIN = 5.0  # times the fastest joint's speed limit
DISTANCE = 1e5  # m from the origin, where float32 no longer resolves a centimetre
QUATERNION_ERROR = 0.01  # of its norm
STOPPING_TIME = 1e-3  # s in which the largest force stops the whole robot


class Quantity(NamedTuple):
    """One number of a ``RobotState`` and what it may be."""

    name: str
    unit: str
    low: float
    high: float


@cache
def quantities(robot: Robot) -> tuple[Quantity, ...]:
    """Every number of a state but the quaternion, in the order of `numbers`, with the robot's own bounds."""
    reach = robot.leg.thigh_length + robot.leg.shank
    kick = max(robot.joint_speed_limit) * reach  # m/s, the fastest that a leg can push the ground away
    spin = TRUNK_SPIN * max(robot.joint_speed_limit)
    force = robot.mass * 2.0 * kick / STOPPING_TIME
    # As deep as a leg is long no soft ground gives way; a jump at that speed ends at v^2 / 2g.
    height = (-reach, robot.standing_height + kick**2 / (2.0 * GRAVITY))
    stops = zip(JOINT_NAMES, robot.joint_lower, robot.joint_upper, strict=True)
    felt = (*(f"{leg}_foot" for leg in FOOT_NAMES), "base", *(f"{leg}_thigh" for leg in FOOT_NAMES))
    return (
        *(Quantity(f"base {axis}", "m", -DISTANCE, DISTANCE) for axis in "xy"),
        Quantity("base height", "m", *height),
        *(Quantity(f"base velocity {axis}", "m/s", -2.0 * kick, 2.0 * kick) for axis in "xyz"),
        *(Quantity(f"base spin {axis}", "rad/s", -spin, spin) for axis in "xyz"),
        *(Quantity(name, "rad", low - JOINT_EXCESS, high + JOINT_EXCESS) for name, low, high in stops),
        *(
            Quantity(f"{name} speed", "rad/s", -JOINT_SPEED * limit, JOINT_SPEED * limit)
            for name, limit in zip(JOINT_NAMES, robot.joint_speed_limit, strict=True)
        ),
        *(Quantity(f"force on {part} {axis}", "N", -force, force) for part in felt for axis in "xyz"),
    )


def numbers(state: RobotState) -> Tensor:
    """(N, D) the numbers that `quantities` bounds."""
    return torch.cat(
        [
            state.base_position,
            state.base_linear_velocity,
            state.base_angular_velocity,
            state.joint_position,
            state.joint_velocity,
            state.foot_force.flatten(1),
            state.body_force.flatten(1),
        ],
        dim=1,
    )


def diverged(robot: Robot, state: RobotState) -> Tensor:
    """(N,) bool: robots with a number that is not finite or beyond what is physically possible.

    Judges the float32 values that observations, rewards and discriminators are computed from.
    """
    values, (middle, scale) = numbers(state), _bounds(robot)
    # How far from the middle, 1 at a bound; the largest of a row with NaN is NaN, with which no comparison holds.
    furthest = ((values - constant(middle, values)).abs() * constant(scale, values)).amax(dim=1)
    rotation = (state.base_quaternion.norm(dim=1) - 1.0).abs()
    return ~((furthest <= 1.0) & (rotation <= QUATERNION_ERROR))


def impossible(robot: Robot, state: RobotState) -> list[str]:
    """What is wrong with the first of N robots, one line each: ``base height = 1e+08 m (-0.4 to 8.7)``."""
    found = [
        f"{one.name} = {value:g} {one.unit} ({one.low:.3g} to {one.high:.3g})"
        for one, value in zip(quantities(robot), numbers(state)[0].tolist(), strict=True)
        if not one.low <= value <= one.high
    ]
    norm = float(state.base_quaternion[0].norm())
    return found if abs(norm - 1.0) <= QUATERNION_ERROR else [*found, f"norm of the base quaternion = {norm:g} (1)"]


@cache
def _bounds(robot: Robot) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The middle of each number's bounds, and 1 / half of their distance."""
    bounds = quantities(robot)
    return tuple((one.low + one.high) / 2.0 for one in bounds), tuple(2.0 / (one.high - one.low) for one in bounds)
