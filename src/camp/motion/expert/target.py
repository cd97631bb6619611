"""What the robot should do at a given time: the reference motion carried along by the heading frame.

The gait begins at t = 0; before it the robot stands on four legs and moves its CoM to the gait's height.
"""

from __future__ import annotations

import numpy as np

from camp.gaits.schedule import GaitSchedule
from camp.motion.expert.heading import advance_heading
from camp.motion.expert.reference import PeriodicReference, nominal_footholds
from camp.motion.expert.rigid_body import ANGULAR, LINEAR, POSITION, RPY, STATE_SIZE, yaw_rotation
from camp.robots.quadruped import GRAVITY

SETTLE_DURATION = 2.0  # s, at most, in which a standing robot takes on the gait's height
LARGEST_LAG = 0.06  # m the heading frame may be ahead of the robot before it waits


class MotionTarget:
    """Reference states, contact forces and footholds in the world frame, as seen from `time`.

    heading: (3,) x, y, yaw of the heading frame at `time`; command: (3,) twist it moves on with.
    """

    def __init__(
        self, reference: PeriodicReference, stand_height: float, stand_duration: float, foot_radius: float
    ) -> None:
        """stand_height: of the standing robot's CoM, m; stand_duration: before the gait begins, s; foot_radius: m."""
        self.reference, self.foot_radius = reference, foot_radius
        self.schedule: GaitSchedule = reference.schedule
        self.time = -stand_duration
        self.heading = np.zeros(3)
        self.command = np.zeros(3)
        self._stand_height, self._stand_duration = stand_height, stand_duration
        self._nominal = nominal_footholds(reference.posture)

    def advance(self, duration: float) -> None:
        """Move on by `duration` s."""
        self.heading = advance_heading(self.heading, self.command, duration)
        self.time += duration

    def contact(self, time: float) -> np.ndarray:
        """Which legs (4,) should stand."""
        return np.ones(4, dtype=bool) if time < -1e-6 else self.schedule.contact(time)

    def heading_at(self, time: float) -> np.ndarray:
        """Pose (3,) of the heading frame."""
        return advance_heading(self.heading, self.command, time - self.time)

    def state(self, time: float) -> np.ndarray:
        """SRB state (12,) of the reference."""
        heading = self.heading_at(time)
        rotation = yaw_rotation(heading[2])
        deviation = self._deviation(time)
        state = np.empty(STATE_SIZE)
        state[RPY] = deviation[RPY] + [0.0, 0.0, heading[2]]
        state[POSITION] = rotation @ deviation[POSITION] + [heading[0], heading[1], 0.0]
        state[ANGULAR] = rotation @ deviation[ANGULAR] + [0.0, 0.0, self.command[2]]
        state[LINEAR] = rotation @ (deviation[LINEAR] + [self.command[0], self.command[1], 0.0])
        return state

    def forces(self, time: float) -> np.ndarray:
        """Contact forces (4, 3) in N of the reference."""
        if time < -1e-6:
            return np.tile([0.0, 0.0, self.reference.body.mass * GRAVITY / 4], (4, 1))
        return self.reference.force(time) @ yaw_rotation(self.heading_at(time)[2]).T

    def error(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Horizontal position (3,) and velocity (3,) of `state` minus the reference's, z zero."""
        difference = state - self.state(self.time)
        level = np.array([1.0, 1.0, 0.0])
        return difference[POSITION] * level, difference[LINEAR] * level

    def wait_for(self, state: np.ndarray) -> None:
        """Draw the heading frame back to the robot where it has run away from it (or the other way round)."""
        position, _ = self.error(state)
        distance = float(np.linalg.norm(position))
        if distance > LARGEST_LAG:
            self.heading[:2] += position[:2] * (1.0 - LARGEST_LAG / distance)

    def foothold(self, leg: int, touchdown: float, shift: np.ndarray) -> np.ndarray:
        """Centre (3,) of a foot that touches down at time `touchdown`, moved by the feedback `shift` (3,)."""
        heading = self.heading_at(touchdown + self.schedule.stance_duration / 2)
        nominal = yaw_rotation(heading[2]) @ self._nominal[leg]
        return nominal + shift + [heading[0], heading[1], self.foot_radius]

    def _deviation(self, time: float) -> np.ndarray:
        if time >= 0.0:
            return self.reference.deviation(time)
        settle = min(self._stand_duration, SETTLE_DURATION)
        fraction = max(0.0, 1.0 - (time + self._stand_duration) / settle)
        deviation = np.zeros(STATE_SIZE)
        deviation[5] = fraction * self._stand_height + (1.0 - fraction) * self.reference.posture.com_height
        return deviation
