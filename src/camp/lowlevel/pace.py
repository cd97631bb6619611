"""When a control step begins: by the clock, or when a simulated robot asks for it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Protocol

from camp.lowlevel.messages import Reading
from camp.lowlevel.transport import RobotLink

POLL_S = 0.0005


@dataclass(frozen=True)
class Beat:
    """The beginning of a control step."""

    now_s: float
    late_s: float  # behind its time
    reading: Reading | None  # that came since the step before
    step: int = 0  # in lockstep: which state waits for an answer


class Pace(Protocol):
    """Waits for control steps."""

    def next(self, link: RobotLink) -> Beat:
        """Wait for the next control step."""
        ...


class RealTime:
    """By the clock. A step that is late is not made up for: the next ones keep their distance."""

    def __init__(self, period_s: float):
        self._period_s = period_s
        self._due_s: float | None = None

    def next(self, link: RobotLink) -> Beat:
        """Sleep until the step is due."""
        due = time.monotonic() if self._due_s is None else self._due_s
        time.sleep(max(0.0, due - time.monotonic()))
        now = time.monotonic()
        late = now - due
        self._due_s = due + self._period_s if late < self._period_s else now + self._period_s
        return Beat(now, late, link.receive())


class Lockstep:
    """By the simulated robot: each of its states waits for its answer, however long that takes.

    Where the robot has gone, time goes on without it, so that its loss is seen.
    """

    def __init__(self, period_s: float):
        self._period_s = period_s
        self._step = 0

    def next(self, link: RobotLink) -> Beat:
        """Wait for the state of the next step."""
        reading = link.receive()
        while (reading is None or reading.step <= self._step) and link.connected:
            time.sleep(POLL_S)
            reading = link.receive() or reading
        if reading is None or reading.step <= self._step:
            reading, self._step = None, self._step + 1
        else:
            self._step = reading.step
        return Beat(self._step * self._period_s, 0.0, reading, self._step)
