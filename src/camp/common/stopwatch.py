"""How long the parts of a whole take, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable


class Stopwatch:
    """Runs from its construction on. clock: s, for tests."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter):
        self._clock, self._began = clock, clock()
        self._last = self._began
        self.parts: dict[str, float] = {}  # s

    def lap(self, name: str) -> None:
        """What happened since the last lap was this part."""
        now = self._clock()
        self.parts[name], self._last = now - self._last, now

    @property
    def total(self) -> float:
        """s since the construction."""
        return self._clock() - self._began
