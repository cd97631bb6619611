"""Time on the screen as physics timesteps, and how much of it the machine manages."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

LONGEST_BACKLOG_S = 0.2  # simulated; more is dropped: a slow machine shows slow motion, and does not race afterwards
LONGEST_TURN_S = 0.04  # of simulating without a look at buttons and picture
WINDOW_S = 1.0  # over which the real-time factor is taken


class Clock:
    """Runs a task of one physics timestep as often as time has passed for it."""

    def __init__(self, step_s: float, now: Callable[[], float] = time.perf_counter):
        """step_s: the physics timestep; now: seconds of a clock that never goes back."""
        self._step_s, self._now = step_s, now
        self.speed = 1.0  # simulated seconds per second, as asked for
        self._paused = False
        self._backlog_s = 0.0
        self._last_s = now()
        self._simulated_s = 0.0
        self._seen: deque[tuple[float, float]] = deque([(self._last_s, 0.0)])  # (time, simulated until then)

    @property
    def paused(self) -> bool:
        """Whether time stands still."""
        return self._paused

    @paused.setter
    def paused(self, value: bool) -> None:
        self._paused = value
        self._backlog_s = 0.0
        self._last_s = self._now()
        self._seen = deque([(self._last_s, self._simulated_s)])

    def advance(self, tick: Callable[[], None]) -> None:
        """Run ``tick`` for the time that has passed since the last call."""
        begin = self._now()
        passed, self._last_s = begin - self._last_s, begin
        if self._paused:
            return
        self._backlog_s = min(self._backlog_s + passed * self.speed, LONGEST_BACKLOG_S)
        while self._backlog_s >= self._step_s and self._now() - begin < LONGEST_TURN_S:
            tick()
            self._backlog_s -= self._step_s
            self._simulated_s += self._step_s
        self._seen.append((begin, self._simulated_s))
        while len(self._seen) > 2 and begin - self._seen[1][0] >= WINDOW_S:
            self._seen.popleft()

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second over the latest WINDOW_S; 0 in a pause, and before any time has passed."""
        (begin, before), (end, after) = self._seen[0], self._seen[-1]
        return (after - before) / (end - begin) if end > begin else 0.0
