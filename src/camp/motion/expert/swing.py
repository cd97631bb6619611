"""Swing legs: where the foot goes and how it gets there."""

from __future__ import annotations

import numpy as np

from camp.gaits.schedule import GaitSchedule
from camp.motion.expert.parameters import SwingGains
from camp.motion.expert.robot_state import RobotState
from camp.motion.expert.target import MotionTarget


def minimum_jerk(fraction: float, duration: float) -> tuple[float, float, float]:
    """Position, velocity, acceleration of a unit move from rest to rest in `duration` s; fraction in [0, 1]."""
    position = fraction**3 * (10 - 15 * fraction + 6 * fraction**2)
    velocity = 30 * fraction**2 * (1 - fraction) ** 2 / duration
    acceleration = 60 * fraction * (1 - fraction) * (1 - 2 * fraction) / duration**2
    return position, velocity, acceleration


def lift(fraction: float, duration: float) -> tuple[float, float, float]:
    """Height, velocity, acceleration of 16 s^2 (1 - s)^2: up to 1 in mid-swing, at rest at both ends."""
    height = 16 * fraction**2 * (1 - fraction) ** 2
    velocity = 32 * fraction * (1 - fraction) * (1 - 2 * fraction) / duration
    acceleration = 32 * (1 - 6 * fraction + 6 * fraction**2) / duration**2
    return height, velocity, acceleration


def foothold_shift(position_error: np.ndarray, velocity_error: np.ndarray, gains: SwingGains) -> np.ndarray:
    """Capture-point feedback (3,) in m: step to where the robot is, and further where it is too fast."""
    return position_error + gains.velocity_gain * velocity_error


class SwingLegs:
    """Remembers where each foot left the floor and where it is heading to."""

    def __init__(self, schedule: GaitSchedule, gains: SwingGains, height: float) -> None:
        self._schedule, self._gains, self._height = schedule, gains, height
        self._start = np.zeros((4, 3))
        self._goal = np.zeros((4, 3))
        self._swinging = np.zeros(4, dtype=bool)

    def land(self, leg: int) -> None:
        """The leg stands: its next swing starts afresh."""
        self._swinging[leg] = False

    def acceleration(self, leg: int, robot: RobotState, target: MotionTarget, shift: np.ndarray) -> np.ndarray:
        """Acceleration (3,) in m/s^2 that keeps a swinging foot on its way."""
        gains, schedule = self._gains, self._schedule
        duration = schedule.swing_duration
        fraction = float((schedule.phase(target.time)[leg] - schedule.duty) / (1.0 - schedule.duty))
        fraction = min(max(fraction, 0.0), 1.0)
        lifting_off = not self._swinging[leg]
        if lifting_off:
            self._start[leg] = robot.foot[leg]
            self._swinging[leg] = True
        if lifting_off or fraction < gains.commit_phase:
            self._goal[leg] = target.foothold(leg, target.time + (1.0 - fraction) * duration, shift)

        path = self._goal[leg] - self._start[leg]
        early = gains.arrival_phase
        move = minimum_jerk(min(fraction / early, 1.0), early * duration)
        rise = self._height * np.outer(lift(fraction, duration), [0.0, 0.0, 1.0])
        position, velocity, acceleration = np.outer(move, path) + rise
        position += self._start[leg]
        return (
            acceleration
            + gains.stiffness * (position - robot.foot[leg])
            + gains.damping * (velocity - robot.foot_velocity[leg])
        )
