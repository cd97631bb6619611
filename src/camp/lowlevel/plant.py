"""The simulated robot behind imperfect channels: commands go in, readings come out, time passes in between."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from camp.lowlevel.conditions import Channel, Conditions
from camp.lowlevel.messages import REMOTE_BYTES, Command, Reading
from camp.lowlevel.simulated_robot import SimulatedRobot
from camp.lowlevel.watchdog import Watchdog

RECORD_S = 0.02  # between two rows of the record
UPSIDE_DOWN = math.pi / 2  # rad: tilted further, it lies on its side or back


@dataclass(frozen=True)
class Setup:
    """What a simulated robot meets."""

    commands: Conditions = field(default_factory=Conditions)
    states: Conditions = field(default_factory=Conditions)
    hold_s: float = math.inf  # of the watchdog
    seed: int = 0


class Plant:
    """Robot, watchdog and the two channels."""

    def __init__(self, robot: SimulatedRobot, setup: Setup):
        self.robot = robot
        self.commands: Channel[Command] = Channel(setup.commands, setup.seed)
        self.states: Channel[Reading] = Channel(setup.states, setup.seed + 1)
        self.watchdog = Watchdog(setup.hold_s)
        self.remote = bytes(REMOTE_BYTES)
        self._record: list[list[float]] = []
        self._newest = robot.reading(self.remote)  # that has arrived

    @property
    def now_s(self) -> float:
        """Simulated time."""
        return float(self.robot.data.time)

    def tell(self, command: Command) -> None:
        """A command leaves the controller."""
        self.commands.put(self.now_s, command)

    def advance(self, seconds: float) -> None:
        """Let time pass, a multiple of the timestep; the robot's state is sent at its end. Raises SimulationError."""
        every = round(RECORD_S / self.robot.timestep_s)
        for _ in range(round(seconds / self.robot.timestep_s)):
            self.robot.step(self.watchdog.command(self.now_s, self.commands.get(self.now_s)))
            if round(self.now_s / self.robot.timestep_s) % every == 0:
                self._record.append([self.now_s, self.robot.height, self.robot.tilt, *self.robot.contact])
        self.states.put(self.now_s, self.robot.reading(self.remote))

    def listen(self) -> Reading | None:
        """The newest reading that has reached the controller since the last call; None where none has."""
        arrived = self.states.get(self.now_s)
        self._newest = arrived or self._newest
        return arrived

    def answer(self, step: int) -> Reading:
        """In lockstep a message always comes: where none has arrived, the last one once more, of its old time."""
        self.listen()
        return replace(self._newest, step=step)

    def record(self) -> dict[str, np.ndarray]:
        """Every RECORD_S: time_s (T,), height_m (T,), tilt_rad (T,), contact (T, 4) in the order of FOOT_NAMES."""
        rows = np.array(self._record).reshape(-1, 7)
        return {"time_s": rows[:, 0], "height_m": rows[:, 1], "tilt_rad": rows[:, 2], "contact": rows[:, 3:] > 0}

    def posture(self) -> str:
        """How the robot is now, for a human."""
        if self.robot.tilt > UPSIDE_DOWN:
            return "on its back"
        still = bool(np.abs(self.robot.data.qvel).max() < 0.5)
        return (
            f"{'at rest' if still else 'moving'}, base {self.robot.height:.2f} m high, tilt {self.robot.tilt:.2f} rad"
        )
