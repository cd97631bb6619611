"""A controller and a simulated robot in one process, and readings made by hand."""

from __future__ import annotations

import numpy as np

from camp.deployment.loop import Policy
from camp.lowlevel.controller import Controller, Desk
from camp.lowlevel.message_log import MessageLog
from camp.lowlevel.messages import Array, Reading
from camp.lowlevel.operator import Wanted
from camp.lowlevel.pace import Lockstep
from camp.lowlevel.plant import Plant, Setup
from camp.lowlevel.script import Script, read_script
from camp.lowlevel.simulated_robot import SimulatedRobot
from camp.lowlevel.walker import Walker
from camp.robots.registry import find_robot
from tests.lowlevel.in_process import InProcessLink


def joints(value: float) -> Array:
    """The same number for every joint."""
    return np.full(12, value, np.float32)


def reading(time_ms: int = 0, tilt: float = 0.0, position: Array | None = None) -> Reading:
    """A robot at rest, rolled by ``tilt`` rad."""
    attitude = np.array([np.cos(tilt / 2), np.sin(tilt / 2), 0.0, 0.0], np.float32)
    return Reading(
        time_ms, joints(0.0) if position is None else position, joints(0.0), attitude, np.zeros(3, np.float32)
    )


class Rig:
    """One session from lying to lying, scripted."""

    def __init__(self, policy: Policy, script: str, setup: Setup | None = None):
        walker = Walker(policy)
        self.plant = Plant(SimulatedRobot(find_robot("go2")), setup or Setup())
        self.link = InProcessLink(self.plant, walker.period_s)
        self.log = MessageLog(None)
        wanted = Wanted.of(policy.metadata, None)
        desk = Desk(Script(read_script(script, wanted.skills)), wanted, self.log)
        self.controller = Controller(self.link, walker, Lockstep(walker.period_s), desk)

    def rests_on_its_legs(self) -> bool:
        """Whether the robot lies upright and still."""
        data = self.plant.robot.data
        return self.plant.robot.height < 0.15 and self.plant.robot.tilt < 0.3 and bool(np.abs(data.qvel).max() < 0.5)
