"""How well a motion follows what was asked: base velocity against the command.

Pure numpy. T control steps, three command entries vx, vy (m/s) and wz (rad/s) in the base frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camp.robots.quadruped import JOINT_KINDS

Array = NDArray[np.floating]

FAST_COMMAND_M_S = 0.4  # from here on errors are reported apart: slower commands are nearly met by standing


@dataclass(frozen=True)
class VelocityError:
    """linear (...,), m/s: length of the planar error; angular (...,), rad/s: size of the yaw rate's error."""

    linear: Array
    angular: Array


def velocity_error(command: Array, velocity: Array) -> VelocityError:
    """Error of a velocity against its command, entry by entry.

    command, velocity: (..., 3) as vx, vy (m/s), wz (rad/s), broadcast against each other. Returns shapes
    (...,). Give the velocity of every step for the instantaneous error, which includes the sway that every
    gait has within a stride, or `mean_velocity(...)` for the error of the speed travelled.
    """
    error = np.asarray(velocity, dtype=np.float64) - np.asarray(command, dtype=np.float64)
    return VelocityError(linear=np.hypot(error[..., 0], error[..., 1]), angular=np.abs(error[..., 2]))


def mean_velocity(velocity: Array, period_s: float, frequency_hz: float | None = None) -> Array:
    """Mean over time of (..., T, 3), shape (..., 3).

    With a stride frequency (Hz) the mean spans whole strides only, counted back from the end: a fractional
    stride leaves part of the sway in. Where not one stride fits, and without a frequency, all T steps count.
    """
    velocity = np.asarray(velocity, dtype=np.float64)
    steps = velocity.shape[-2]
    if frequency_hz is not None:
        strides = np.floor(steps * period_s * frequency_hz)
        if strides >= 1:
            steps = round(strides / (period_s * frequency_hz))
    return velocity[..., -steps:, :].mean(axis=-2)


def velocity_error_by_command(
    command: Array, error: VelocityError, edges: tuple[float, ...]
) -> dict[str, VelocityError]:
    """Mean error per bin of commanded speed, so that slow commands cannot hide behind fast ones.

    command: (G, 3); error: fields (..., G), leading axes (skills, seeds) are averaged; edges: rising speeds
    in m/s that part the bins, compared with the length of (vx, vy). Bins without a command are left out; for
    edges (0.4,) the keys are "below 0.4 m/s" and "from 0.4 m/s".
    """
    return _by_bin(np.hypot(command[:, 0], command[:, 1]), error, edges, "m/s")


def velocity_error_by_turn(command: Array, error: VelocityError, edges: tuple[float, ...]) -> dict[str, VelocityError]:
    """As `velocity_error_by_command`, by the size of the commanded yaw rate; edges in rad/s."""
    return _by_bin(np.abs(command[:, 2]), error, edges, "rad/s")


def by_joint_kind(value: Array) -> dict[str, Array]:
    """Mean over the four legs of (..., 12) in canonical joint order, keyed hip, thigh, calf, each (...,)."""
    per_leg = np.asarray(value).reshape(*np.shape(value)[:-1], 4, 3)
    return {kind: per_leg[..., i].mean(axis=-1) for i, kind in enumerate(JOINT_KINDS)}


def _by_bin(size: Array, error: VelocityError, edges: tuple[float, ...], unit: str) -> dict[str, VelocityError]:
    index = np.digitize(size, edges)
    result = {}
    for i in np.unique(index):
        chosen = index == i
        result[_bin_name(int(i), edges, unit)] = VelocityError(
            linear=error.linear[..., chosen].mean(), angular=error.angular[..., chosen].mean()
        )
    return result


def _bin_name(index: int, edges: tuple[float, ...], unit: str) -> str:
    if index == 0:
        return f"below {edges[0]:g} {unit}"
    if index == len(edges):
        return f"from {edges[-1]:g} {unit}"
    return f"{edges[index - 1]:g} to {edges[index]:g} {unit}"
