"""The motions besides the policy's: standing up, lying down, and damping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camp.lowlevel.messages import Array, Command, Reading
from camp.robots.quadruped import NUM_JOINTS, NUM_LEGS

FOLDED = np.array((0.0, 1.36, -2.65) * NUM_LEGS, np.float32)  # rad, lying on folded legs: Unitree's stand example
STIFF_KP, STIFF_KD = 60.0, 5.0  # N m/rad, N m s/rad: Unitree's stand example
DAMPING_KD = 3.0  # N m s/rad: a raised leg sinks slowly
FOLD_S, RISE_S, SOFTEN_S = 1.0, 2.0, 0.5  # parts of standing up
LIE_S = 1.5  # down from standing
DROP_S = 0.3  # down from a walk: slower, it tips over its own legs (docs/go2.md)
REST_S = 0.7  # on folded legs, until it has come to rest


@dataclass(frozen=True)
class Waypoint:
    """Where the joints are after some time, and how stiff."""

    seconds: float  # from the waypoint before
    pose: Array  # (12,) rad
    kp: Array  # (12,)
    kd: Array  # (12,)


@dataclass(frozen=True)
class Way:
    """Targets and gains from a first command through waypoints, without a jump in either."""

    start: Command
    waypoints: Sequence[Waypoint]

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return sum(waypoint.seconds for waypoint in self.waypoints)

    def at(self, elapsed_s: float) -> Command:
        """The command so long after the start; at the end, the last waypoint's."""
        target, kp, kd = self.start.target, self.start.kp, self.start.kd
        for waypoint in self.waypoints:
            part = min(max(elapsed_s / waypoint.seconds, 0.0), 1.0)
            share = part * part * (3 - 2 * part)  # at rest at both ends
            target = _between(target, waypoint.pose, share)
            kp, kd = _between(kp, waypoint.kp, share), _between(kd, waypoint.kd, share)
            elapsed_s -= waypoint.seconds
            if elapsed_s < 0:
                break
        return Command(target, kp, kd)


def damping() -> Command:
    """No position to hold, only resistance."""
    return Command(_all(0.0), _all(0.0), _all(DAMPING_KD))


def stand_up(reading: Reading, pose: Array, kp: Array, kd: Array) -> Way:
    """From where the joints are, over folded legs, to a pose (12,), rad, that ends with the policy's gains (12,)."""
    stiff = _all(STIFF_KP), _all(STIFF_KD)
    return Way(
        Command(reading.joint_position, *stiff),
        [Waypoint(FOLD_S, FOLDED, *stiff), Waypoint(RISE_S, pose, *stiff), Waypoint(SOFTEN_S, pose, kp, kd)],
    )


def lie_down(last: Command, seconds: float) -> Way:
    """From the last command onto folded legs, where it stays until it lies at rest.

    It needs no reading: it is also the way out when none come.
    """
    stiff = _all(STIFF_KP), _all(STIFF_KD)
    return Way(last, [Waypoint(seconds, FOLDED, *stiff), Waypoint(REST_S, FOLDED, *stiff)])


def _between(one: Array, other: Array, share: float) -> Array:
    return (one + share * (other - one)).astype(np.float32)


def _all(value: float) -> Array:
    return np.full(NUM_JOINTS, value, np.float32)
