"""One robot that follows a policy and the person who plays: orders in, physics timesteps, what the feet did."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camp.deployment.loop import Memory, Policy
from camp.deployment.simulated import Robot
from camp.gaits.skills import NO_SKILL, Skill, performed, split_name
from camp.metrics.contact import debounced
from camp.metrics.gait import NO_GAIT, measure_gait
from camp.robots.quadruped import FOOT_NAMES

KEPT_S = 8.0  # of the walk
WINDOW_S = 1.0  # over which is measured, as `camp.metrics.gait.measure_over_time` does
MEASURED_EVERY_S = 0.1


@dataclass(frozen=True)
class Measured:
    """What feet and trunk did in the latest WINDOW_S."""

    gait: str = NO_GAIT
    frequency_hz: float = math.nan
    skill: str = NO_SKILL  # the policy's skill that gait and frequency show
    velocity: tuple[float, float, float] | None = None  # mean vx, vy in m/s, yaw rate in rad/s, base frame


@dataclass(frozen=True)
class Moment:
    """The end of one control step."""

    contact: tuple[bool, ...]  # FL, FR, RL, RR
    velocity: NDArray[np.float32]  # (3,) vx, vy in m/s, yaw rate in rad/s, base frame
    skill: str  # as asked for
    gait: str  # as measured
    pushed: bool


class Session:
    """A simulated robot, its policy, and the orders in force."""

    def __init__(self, policy: Policy, push_m_s: float):
        """push_m_s: change of the trunk's velocity by a push, m/s."""
        self.policy, self.robot = policy, Robot(policy.metadata)
        self.period_s: float = policy.metadata["control_period"]
        self.skills: list[str] = policy.metadata["skills"]
        self.skill, self.command = self.skills[0], [0.0, 0.0, 0.0]
        self._push_m_s, self._side = push_m_s, 1.0
        self._known = [Skill(*split_name(name)) for name in self.skills]
        self._memory = Memory(policy)
        self.moments: deque[Moment] = deque(maxlen=round(KEPT_S / self.period_s))
        self.reset()

    def choose(self, skill: str) -> None:
        """Ask for a skill. Raises CampError for one that the policy does not know."""
        self.policy.one_hot(skill)
        self.skill = skill

    def steer(self, command: Sequence[float]) -> None:
        """Ask for vx, vy in m/s and a yaw rate in rad/s; clipped to the range of training."""
        self.command = self.policy.within_range(command)

    def push(self) -> tuple[float, float]:
        """Push the trunk from the right and the left in turn; returns the direction, a unit vector in the world."""
        angle = self.robot.heading + self._side * math.pi / 2
        direction = math.cos(angle), math.sin(angle)
        self.robot.push(*(self._push_m_s * part for part in direction))
        self._side, self._pushed = -self._side, True
        self.pushes += 1
        return direction

    def reset(self) -> None:
        """Stand the robot up at the start. Skill and command stay as they are."""
        self.robot.stand()
        self._memory.clear()
        self.moments.clear()
        self._substep, self._steps = 0, 0
        self.fallen, self._pushed = False, False
        self.measured, self.pushes = Measured(), 0  # pushes: since the start

    def tick(self) -> None:
        """Let one physics timestep pass; the policy is asked at the first of each control period.

        After a fall the motors only damp. Raises CampError where the policy's answer or the robot's state is not
        finite.
        """
        if self._substep == 0:
            robot = self.robot
            robot.aim(robot.joint_position if self.fallen else self._memory.target(robot, self.skill, self.command))
        self.robot.step()
        self._substep = (self._substep + 1) % self.robot.substeps
        if self._substep == 0:
            self._record()

    def contacts(self) -> NDArray[np.bool_]:
        """(T, 4) of the latest T control steps, at most KEPT_S: without bounces, as is measured."""
        rows = np.array([moment.contact for moment in self.moments], dtype=bool).reshape(-1, len(FOOT_NAMES))
        return debounced(rows, self.period_s)

    def _record(self) -> None:
        self.fallen = self.fallen or self.robot.fallen
        if self._steps % round(MEASURED_EVERY_S / self.period_s) == 0:
            self.measured = self._measure()
        touches = tuple(self.robot.touches(foot) for foot in FOOT_NAMES)
        self.moments.append(Moment(touches, self.robot.velocity, self.skill, self.measured.gait, self._pushed))
        self._steps += 1
        self._pushed = False

    def _measure(self) -> Measured:
        length = round(WINDOW_S / self.period_s)
        if self.fallen or len(self.moments) < length:
            return Measured()
        gait = measure_gait(self.contacts()[None, -length:], self.period_s)
        velocity = np.mean([moment.velocity for moment in list(self.moments)[-length:]], axis=0, dtype=float)
        vx, vy, yaw_rate = velocity.tolist()
        return Measured(
            gait=str(gait.label[0]),
            frequency_hz=float(gait.frequency_hz[0]),
            skill=str(performed(gait.label, gait.frequency_hz, self._known)[0]),
            velocity=(vx, vy, yaw_rate),
        )
