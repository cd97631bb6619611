"""Time on the screen becomes physics timesteps; what the machine does not manage shows in the real-time factor."""

from __future__ import annotations

import pytest

from camp.play.clock import LONGEST_BACKLOG_S, Clock

STEP_S = 0.005


class Watch:
    """A clock that goes on by hand."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


class Machine:
    """Counts timesteps, each of which takes a while."""

    def __init__(self, watch: Watch, cost_s: float = 0.0):
        self.watch, self.cost_s, self.steps = watch, cost_s, 0

    def tick(self) -> None:
        self.steps += 1
        self.watch.now_s += self.cost_s


def turns(clock: Clock, machine: Machine, number: int, rest_s: float = 0.01) -> None:
    for _ in range(number):
        machine.watch.now_s += rest_s
        clock.advance(machine.tick)


@pytest.mark.parametrize("speed", [1.0, 0.25, 2.0])
def test_as_many_timesteps_as_the_speed_asks_for(speed):
    watch = Watch()
    clock, machine = Clock(STEP_S, watch), Machine(watch)
    clock.speed = speed
    turns(clock, machine, 300)
    assert machine.steps == pytest.approx(3.0 * speed / STEP_S, abs=1)
    assert clock.real_time_factor == pytest.approx(speed, rel=0.02)


def test_a_machine_that_is_too_slow_is_told():
    """Each timestep takes twice its own time: half of real time at most, and no race afterwards."""
    watch = Watch()
    clock, machine = Clock(STEP_S, watch), Machine(watch, cost_s=2 * STEP_S)
    turns(clock, machine, 100, rest_s=0.001)
    assert 0.4 < clock.real_time_factor < 0.5
    before, machine.cost_s = machine.steps, 0.0
    watch.now_s += 60.0
    clock.advance(machine.tick)
    assert machine.steps - before == pytest.approx(LONGEST_BACKLOG_S / STEP_S, abs=1)


def test_the_factor_forgets_what_is_longer_ago_than_a_second():
    watch = Watch()
    clock, machine = Clock(STEP_S, watch), Machine(watch)
    turns(clock, machine, 200)
    clock.speed = 0.5
    turns(clock, machine, 110)
    assert clock.real_time_factor == pytest.approx(0.5, rel=0.05)


def test_time_stands_still_in_a_pause_and_is_not_made_up_for():
    watch = Watch()
    clock, machine = Clock(STEP_S, watch), Machine(watch)
    clock.paused = True
    turns(clock, machine, 500)
    assert (machine.steps, clock.real_time_factor) == (0, 0.0)
    watch.now_s += 5.0
    clock.paused = False
    turns(clock, machine, 10)
    assert machine.steps == pytest.approx(0.1 / STEP_S, abs=1)
