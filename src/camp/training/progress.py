"""Live progress of training: an updating table on a terminal, plain lines elsewhere."""

from __future__ import annotations

import math
import re
import sys
import time
from collections.abc import Callable, Mapping
from datetime import timedelta
from typing import TextIO

from rich.console import Console
from rich.live import Live
from rich.table import Table

from camp.runs.metrics import Metric

#: The rows in order of display: which metric keys each holds, and in group 1 what is shown of the key. The rest is in
#: metrics.jsonl and W&B.
SECTIONS = {
    "reward": re.compile(r"reward/(\w+)/raw"),
    "error": re.compile(r"tracking/(\w+)"),
    "gait accuracy": re.compile(r"gait/(\w+)(?:/accuracy)?"),
    "prior": re.compile(r"prior/(\w+/(?:accuracy|\w+_logit))"),
    "policy": re.compile(r"ppo/(kl|std|learning_rate)"),
    "episodes": re.compile(r"env/(falls_per_1000_steps)"),
}
_RATE_SMOOTHING = 0.9


class Progress:
    """Shows where training stands: iteration, steps/s, time left, and the metrics in SECTIONS."""

    def __init__(
        self,
        total: int,
        steps_per_iteration: int,
        stream: TextIO | None = None,
        lines_every: int = 10,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`total` iterations of `steps_per_iteration` environment steps; off a terminal one line is printed
        for the first, the last and every `lines_every`-th iteration."""
        self.total = total
        self.steps_per_iteration = steps_per_iteration
        self.lines_every = lines_every
        self._clock = clock
        self._last: float | None = None
        self._shown: dict[str, float] = {}  # the last value of every metric: some come only now and then
        self._seconds: float | None = None  # per iteration, smoothed
        console = Console(file=stream if stream is not None else sys.stdout)
        self._console = console
        # Metrics arrive about once a second, so a refreshing thread would only take time from the physics.
        self._live = Live(console=console, auto_refresh=False) if console.is_terminal else None

    def __enter__(self) -> Progress:
        self._last = self._clock()
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    @property
    def steps_per_second(self) -> float:
        """Environment steps per second, smoothed over some ten iterations; nan before the first."""
        return self.steps_per_iteration / self._seconds if self._seconds else math.nan

    def update(self, iteration: int, metrics: Mapping[str, Metric]) -> None:
        """Show the numbers among the `metrics` of `iteration` (the first is 1, `total` the last)."""
        self._shown |= {key: value for key, value in metrics.items() if not isinstance(value, list)}
        now = self._clock()
        if self._last is not None:
            elapsed = max(now - self._last, 1e-9)
            before = elapsed if self._seconds is None else self._seconds
            self._seconds = _RATE_SMOOTHING * before + (1 - _RATE_SMOOTHING) * elapsed
        self._last = now
        if self._live is not None:
            self._live.update(self._table(iteration, self._shown), refresh=True)
        elif iteration in (1, self.total) or iteration % self.lines_every == 0:
            self._console.print(self._line(iteration, self._shown), soft_wrap=True, highlight=False, markup=False)

    def say(self, text: str) -> None:
        """Print a line that stays, above the table on a terminal."""
        self._console.print(text, soft_wrap=True, highlight=False, markup=False)

    def _headline(self, iteration: int) -> str:
        left = "--:--"
        if self._seconds is not None:
            left = str(timedelta(seconds=round((self.total - iteration) * self._seconds)))
        rate = f"{self.steps_per_second:,.0f}" if self._seconds else "--"
        return f"iteration {iteration}/{self.total}  {rate} steps/s  {left} left"

    def _line(self, iteration: int, metrics: Mapping[str, float]) -> str:
        parts = [f"{key}={_short(value)}" for section in _sections(metrics).values() for key, value in section]
        return "  ".join([self._headline(iteration), *parts])

    def _table(self, iteration: int, metrics: Mapping[str, float]) -> Table:
        table = Table(title=self._headline(iteration), title_justify="left", show_header=False)
        for name, section in _sections(metrics).items():
            table.add_row(name, "  ".join(f"{key} {_short(value)}" for key, value in section))
        return table


def _sections(metrics: Mapping[str, float]) -> dict[str, list[tuple[str, float]]]:
    """The metrics of each section that has any."""
    found = {
        name: [(match[1], value) for key, value in metrics.items() if (match := pattern.fullmatch(key))]
        for name, pattern in SECTIONS.items()
    }
    return {name: section for name, section in found.items() if section}


def _short(value: float) -> str:
    return f"{value:.1e}" if value != 0 and not 1e-3 <= abs(value) < 1e5 else f"{value:.3g}"
