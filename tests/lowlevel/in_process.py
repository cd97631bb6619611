"""A simulated robot in this process, in lockstep: the tests need no network for it."""

from __future__ import annotations

from camp.lowlevel.messages import Command, Reading
from camp.lowlevel.plant import Plant


class InProcessLink:
    """The controller's end of a plant. Every command lets one control period pass."""

    def __init__(self, plant: Plant, period_s: float):
        self._plant, self._period_s = plant, period_s
        self._step = 1
        self.connected = True  # False: the robot is gone
        self.rivals = 0  # commands of somebody else that are still to be seen

    def receive(self) -> Reading | None:
        """The state of this step."""
        return self._plant.answer(self._step) if self.connected else None

    def send(self, command: Command) -> None:
        """Give the motors a command and let time pass."""
        self._plant.tell(command)
        self._plant.advance(self._period_s)
        self._step += 1

    def rival(self) -> bool:
        """Whether one is still to be seen."""
        seen = self.rivals > 0
        self.rivals = 0
        return seen
