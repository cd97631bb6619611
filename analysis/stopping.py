"""How a walking robot is best stopped: ``python -m analysis.stopping policy=<policy.onnx>``.

Every skill walks at 0.6 m/s in the simulation behind `camp.go2_sim`. At several instants of its stride the commands
cease, and the motors are damped at once, or the last target is held for a while before the robot lies down, slowly or
fast. Then: for how long may commands fail in a walk that goes on? Last: how far the policy's targets reach beyond the
joints' ranges.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

import mujoco
import numpy as np
from rich.console import Console
from rich.table import Table

from camp.cli.key_values import key_values, run_command
from camp.deployment.loop import Policy
from camp.lowlevel.messages import REMOTE_BYTES, Command, Reading
from camp.lowlevel.motion import DROP_S, LIE_S, damping, lie_down, stand_up
from camp.lowlevel.simulated_robot import SimulatedRobot
from camp.lowlevel.state_machine import HOLD_S, LARGEST_TILT
from camp.lowlevel.walker import Walker
from camp.robots.registry import find_robot

VELOCITY = (0.6, 0.0, 0.0)
WALKED_S = 2.0  # before the first stop
INSTANTS = 6  # of stops in one walk
APART_S = 0.08  # between them: together about a stride at 2 Hz
WATCHED_S = 3.0  # after a stop
STOPS: tuple[tuple[float, float], ...] = (  # s held, s to lie down
    (0.1, LIE_S),
    *((hold, DROP_S) for hold in (0.0, HOLD_S, 0.2, 0.5)),
)
OUTAGES_S = (0.04, 0.1, 0.2, 0.3, 0.5)
SWITCH_S = 1.0  # walked in each skill, for the targets' reach


@dataclass
class Moment:
    """A walk as it was when its commands ceased."""

    data: mujoco.MjData
    walker: Walker
    skill: str
    last: Command


class Walks:
    """One simulated robot that is set back to moments of its walks."""

    def __init__(self, policy: Policy):
        self.robot = SimulatedRobot(find_robot(policy.metadata["robot"]))
        self.walker = Walker(policy)
        self._body = self.walker.body()
        way = stand_up(self._reading(), self._body.pose, self._body.kp, self._body.kd)
        begin = self.robot.data.time
        while (elapsed := self.robot.data.time - begin) < way.seconds:
            self.robot.step(way.at(elapsed))
        self._standing = copy.copy(self.robot.data)

    def moments(self, skill: str) -> list[Moment]:
        """Instants of one skill's walk."""
        self._set(self._standing)
        self.walker.start()
        found, last = [], damping()
        period = self.walker.period_s
        first, every = round(WALKED_S / period), round(APART_S / period)
        for step in range(first + INSTANTS * every):
            if step >= first and (step - first) % every == 0:
                found.append(Moment(copy.copy(self.robot.data), copy.copy(self.walker), skill, last))
            last = self._walk(self.walker, skill)
        return found

    def stopped(self, moment: Moment, hold_s: float, lie_s: float | None) -> tuple[float, float]:
        """Largest tilt, and the tilt at the end, rad. lie_s: to lie down, after ``hold_s``; None damps at once."""
        self._set(moment.data)
        way = None if lie_s is None else lie_down(moment.last, lie_s)
        begin, most = self.robot.data.time, 0.0
        while (elapsed := self.robot.data.time - begin) < WATCHED_S:
            lying_s = elapsed - hold_s
            if way is None or lying_s >= way.seconds:
                self.robot.step(damping())
            else:
                self.robot.step(moment.last if lying_s < 0 else way.at(lying_s))
            most = max(most, self.robot.tilt)
        return most, self.robot.tilt

    def resumed(self, moment: Moment, outage_s: float) -> bool:
        """Whether the walk goes on upright after the last target was held for a while."""
        self._set(moment.data)
        walker = copy.copy(moment.walker)
        begin, most = self.robot.data.time, 0.0
        while self.robot.data.time - begin < outage_s - 1e-9:
            self.robot.step(moment.last)
            most = max(most, self.robot.tilt)
        while self.robot.data.time - begin < WATCHED_S:
            self._walk(walker, moment.skill)
            most = max(most, self.robot.tilt)
        return most <= LARGEST_TILT and self.robot.height > 0.2

    def reach(self, skills: Sequence[str]) -> float:
        """How far the targets reach beyond the joints' ranges over every switch of two skills, rad; below 0: within."""
        self._set(self._standing)
        self.walker.start()
        most = -np.inf
        for pair in permutations(skills, 2):
            for skill in pair:
                for _ in range(round(SWITCH_S / self.walker.period_s)):
                    target = self._walk(self.walker, skill).target
                    beyond = np.maximum(self._body.lower - target, target - self._body.upper)
                    most = max(most, float(beyond.max()))
        return most

    def _walk(self, walker: Walker, skill: str) -> Command:
        target = walker.target(self._reading(), skill, VELOCITY)
        assert target is not None
        command = Command(target, self._body.kp, self._body.kd)
        for _ in range(round(walker.period_s / self.robot.timestep_s)):
            self.robot.step(command)
        return command

    def _reading(self) -> Reading:
        return self.robot.reading(bytes(REMOTE_BYTES))

    def _set(self, data: mujoco.MjData) -> None:
        self.robot.data = copy.copy(data)


def report(arguments: Sequence[str]) -> None:
    """Print the tables."""
    policy = Policy(Path(key_values(arguments, required=["policy"])["policy"]))
    walks = Walks(policy)
    skills = policy.metadata["skills"]
    moments = [moment for skill in skills for moment in walks.moments(skill)]
    stops = Table(title=f"stops of {len(moments)} walks at {VELOCITY[0]:g} m/s")
    for heading in ("how", "ended upright", "never tilted by more than 0.8 rad", "largest tilt, rad"):
        stops.add_column(heading, justify="left" if heading == "how" else "right")
    for hold, lie in ((0.0, None), *STOPS):
        most, last = np.array([walks.stopped(moment, hold, lie) for moment in moments]).T
        how = "damped at once" if lie is None else f"held for {hold:g} s, lay down in {lie:g} s, damped"
        stops.add_row(how, f"{(last < LARGEST_TILT).sum()}", f"{(most <= LARGEST_TILT).sum()}", f"{most.max():.2f}")
    outages = Table(title="outages in the same walks, the last target held")
    outages.add_column("s", justify="right")
    outages.add_column("walk went on", justify="right")
    for outage in OUTAGES_S:
        outages.add_row(f"{outage:g}", f"{sum(walks.resumed(moment, outage) for moment in moments)} of {len(moments)}")
    console = Console(width=100)
    console.print(stops)
    console.print(outages)
    print(f"targets beyond the joints' ranges over all switches: {walks.reach(skills):.2f} rad (below 0: within)")


if __name__ == "__main__":
    sys.exit(run_command(report, sys.argv[1:], __doc__))
