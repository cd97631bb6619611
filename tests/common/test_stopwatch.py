"""Laps by a clock of the test's own."""

from __future__ import annotations

from camp.common.stopwatch import Stopwatch


def test_laps_are_the_time_since_the_one_before():
    moments = iter([10.0, 12.0, 15.0, 21.0])
    watch = Stopwatch(clock=lambda: next(moments))
    watch.lap("collect")
    watch.lap("update")
    assert watch.parts == {"collect": 2.0, "update": 3.0} and watch.total == 11.0
