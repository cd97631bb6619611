"""What a motion costs: torques, energy, jerky targets, slipping feet.

Pure numpy. T control steps, J joints, leading axes are robots.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camp.robots.quadruped import GRAVITY

Array = NDArray[np.floating]


def action_rate(joint_target: Array) -> Array:
    """Mean change of the joint targets from one control step to the next, rad per step: (..., T, J) -> (...,)."""
    return np.abs(np.diff(np.asarray(joint_target, dtype=np.float64), axis=-2)).mean(axis=(-2, -1))


def torque_use(torque: Array, limit: Array) -> Array:
    """Largest fraction of its limit that any joint's torque reaches: (..., J) N m and (J,) N m -> (...,)."""
    return np.abs(np.asarray(torque, dtype=np.float64) / np.asarray(limit)).max(axis=-1)


def fraction_at_limit(value: Array, limit: Array, tolerance: float = 0.01) -> Array:
    """Fraction of the samples within ``tolerance`` of their limit: (..., T, J) and (J,) -> (...,); 0.01: 1 %."""
    return (np.abs(value) >= (1.0 - tolerance) * np.asarray(limit)).mean(axis=(-2, -1))


def fraction_near_stop(joint_position: Array, lower: Array, upper: Array, margin: float) -> Array:
    """Fraction of the samples within ``margin`` (rad) of a joint's stop, or beyond: (..., T, J) and (J,) -> (...,)."""
    position = np.asarray(joint_position)
    near = (position < np.asarray(lower) + margin) | (position > np.asarray(upper) - margin)
    return near.mean(axis=(-2, -1))


def velocity_jump(joint_velocity: Array) -> Array:
    """Largest change of any joint's velocity since the step before, rad/s: (..., T, J) -> (..., T), 0 at the first."""
    change = np.diff(np.asarray(joint_velocity, dtype=np.float64), axis=-2)
    return np.concatenate([np.zeros_like(change[..., :1, 0]), np.abs(change).max(axis=-1)], axis=-1)


def foot_slip(foot_speed: Array, contact: NDArray[np.bool_]) -> Array:
    """Mean speed of the feet that stand, m/s: (..., T, 4) and (..., T, 4) bool -> (...,); nan where none stands.

    Only steps in the midst of a stance count, with contact before and after as well: at touchdown and lift-off a
    foot moves by right.
    """
    standing = contact[..., 1:-1, :] & contact[..., :-2, :] & contact[..., 2:, :]
    count = standing.sum(axis=(-2, -1))
    total = np.where(standing, foot_speed[..., 1:-1, :], 0.0).sum(axis=(-2, -1))
    return np.divide(total, count, out=np.full(np.shape(total), np.nan), where=count > 0)


def cost_of_transport(power: Array, velocity: Array, mass: float) -> float | None:
    """Energy per weight and distance, sum of |tau q'| / (m g v), no unit.

    power: (R, T) W, sum over the joints of |torque x joint velocity|; velocity: (R, 2) mean planar velocity, m/s;
    mass: kg. Energy and distance are summed over the R robots before the division, so that one that hardly moves
    cannot blow the figure up. None where they cover less than 1 cm/s on average.
    """
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    if len(speed) == 0 or speed.mean() < 0.01:
        return None
    return float(np.mean(power) / (mass * GRAVITY * speed.mean()))
