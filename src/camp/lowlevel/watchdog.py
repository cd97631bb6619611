"""What the robot's side does when commands cease: hold briefly, lie down with gains, damping last."""

from __future__ import annotations

import math

from camp.lowlevel.messages import Command
from camp.lowlevel.motion import DROP_S, Way, damping, lie_down


class Watchdog:
    """Stands between the commands that arrive and the motors. Once it has acted, later commands count no more."""

    def __init__(self, hold_s: float = math.inf):
        """hold_s: how long the last command is held; inf: for ever, as Unitree's simulator does."""
        self._hold_s = hold_s
        self._last: Command | None = None
        self._heard_s = 0.0
        self._way: Way | None = None

    @property
    def acted(self) -> bool:
        """Whether it has taken the motors."""
        return self._way is not None

    def command(self, now_s: float, arrived: Command | None) -> Command | None:
        """What the motors do now; None before the first command."""
        if arrived is not None and self._way is None:
            self._last, self._heard_s = arrived, now_s
        silent_s = now_s - self._heard_s
        if self._way is None and self._last is not None and silent_s > self._hold_s:
            self._way = lie_down(self._last, DROP_S)
        if self._way is None:
            return self._last
        lying_s = silent_s - self._hold_s
        return self._way.at(lying_s) if lying_s < self._way.seconds else damping()
