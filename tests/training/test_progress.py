"""Live progress: what is shown, how often, and how the remaining time is told."""

from __future__ import annotations

import io
import math

from camp.training.progress import Progress

METRICS = {
    "reward/task/raw": 0.5,
    "reward/style/raw": 0.25,
    "gait/trot/accuracy": 1.0,
    "ppo/kl": 0.0123,
    "ppo/learning_rate": 1e-5,
    "time/physics": 0.7,
}


class Clock:
    """Advances by `step` seconds at each reading."""

    def __init__(self, step: float) -> None:
        self.now, self.step = 0.0, step

    def __call__(self) -> float:
        self.now += self.step
        return self.now


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def show(stream: io.StringIO, total: int, **options) -> str:
    with Progress(total, 1000, stream, clock=Clock(2.0), **options) as progress:
        for iteration in range(1, total + 1):
            progress.update(iteration, METRICS)
    return stream.getvalue()


def test_lines_off_a_terminal():
    lines = show(io.StringIO(), 25, lines_every=10).splitlines()
    assert [line.split()[1] for line in lines] == ["1/25", "10/25", "20/25", "25/25"]
    # 2 seconds for 1000 steps; 15 iterations are left after the tenth.
    assert lines[1].startswith("iteration 10/25  500 steps/s  0:00:30 left  ")
    for part in ("task=0.5", "trot=1", "kl=0.0123", "learning_rate=1.0e-05"):
        assert part in lines[1]
    assert "physics" not in lines[1]


def test_histograms_are_not_shown():
    shown = []
    for metrics in (METRICS, METRICS | {"gait/histogram": [0.5, 0.5]}):
        with Progress(1, 1000, stream := io.StringIO(), clock=Clock(2.0)) as progress:
            progress.update(1, metrics)
        shown.append(stream.getvalue())
    assert shown[0] == shown[1] != ""


def test_table_on_a_terminal(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    shown = show(Terminal(), 2)
    for part in ("iteration 2/2", "500 steps/s", "gait accuracy", "trot 1", "policy"):
        assert part in shown


def test_speed_is_unknown_before_the_first_iteration():
    assert math.isnan(Progress(1, 1, io.StringIO()).steps_per_second)


def test_rate_follows_a_change_slowly():
    clock = Clock(1.0)
    with Progress(100, 1000, io.StringIO(), clock=clock) as progress:
        progress.update(1, {})
        assert progress.steps_per_second == 1000
        clock.step = 2.0
        progress.update(2, {})
        assert progress.steps_per_second == 1000 / 1.1  # 0.9 * 1 s + 0.1 * 2 s
        for iteration in range(3, 90):
            progress.update(iteration, {})
        assert abs(progress.steps_per_second - 500) < 1
