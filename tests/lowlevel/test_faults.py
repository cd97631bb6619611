"""Every fault that is injected into a simulated walk ends in the state that docs/go2.md names."""

from __future__ import annotations

import numpy as np
import pytest

from camp.lowlevel.conditions import Conditions
from camp.lowlevel.pace import Beat
from camp.lowlevel.plant import Setup
from camp.lowlevel.state_machine import Fault, State
from tests.lowlevel.rig import Rig, reading

SCRIPT = "0 stand, 3.6 walk, 3.6 velocity 0.4 0 0"
FAILS_S = 4.5  # in the middle of the walk
QUITS = f"{SCRIPT}, 6 quit"
UP = [State.STANDING_UP, State.STANDING, State.WALKING]


def test_a_walk_ends_lying_at_rest(shipped):
    rig = Rig(shipped, f"{SCRIPT}, 5 skill pace_2hz, 6 quit")
    assert rig.controller.run() is None
    assert rig.log.states == ["passive", *UP, State.LYING_DOWN, State.PASSIVE][1:]
    assert rig.rests_on_its_legs() and rig.plant.robot.data.qpos[0] > 0.3


def test_only_in_lockstep_is_a_state_of_the_same_time_an_old_one(shipped):
    controller = Rig(shipped, SCRIPT).controller
    assert controller._note(Beat(0.0, 0.0, reading(5))) and controller._note(Beat(0.02, 0.0, reading(5)))
    assert not controller._note(Beat(0.04, 0.0, reading(5), step=3))
    assert controller._note(Beat(0.06, 0.0, reading(6), step=4))


def test_a_lost_state_ends_in_lying_down_and_damping(shipped):
    rig = Rig(shipped, SCRIPT, Setup(states=Conditions(outage_at_s=FAILS_S, outage_s=np.inf)))
    assert rig.controller.run() is Fault.STATE_LOST
    assert rig.log.states == [*UP, State.HOLDING, State.LYING_DOWN, State.DAMPING]
    assert rig.plant.robot.tilt < 1.0


def test_a_robot_that_is_gone_is_a_lost_state(shipped):
    rig = Rig(shipped, SCRIPT)
    poll = rig.controller._desk.input.poll

    def gone(now_s, newest, wanted):
        rig.link.connected = now_s < FAILS_S
        return poll(now_s, newest, wanted)

    rig.controller._desk.input.poll = gone  # type: ignore[method-assign]
    assert rig.controller.run() is Fault.STATE_LOST
    assert rig.log.states[-2:] == [State.LYING_DOWN, State.DAMPING]


def test_tilt_ends_in_damping_at_once(shipped):
    rig = Rig(shipped, SCRIPT)
    _at(rig, FAILS_S, lambda: _spin(rig))
    assert rig.controller.run() is Fault.TILT
    assert rig.log.states == [*UP, State.DAMPING]


def test_a_rival_ends_in_damping_at_once(shipped):
    rig = Rig(shipped, SCRIPT)
    _at(rig, FAILS_S, lambda: setattr(rig.link, "rivals", 1))
    assert rig.controller.run() is Fault.RIVAL
    assert rig.log.states == [*UP, State.DAMPING]


def test_a_policy_that_fails_ends_in_lying_down_and_damping(shipped, monkeypatch):
    rig = Rig(shipped, SCRIPT)
    _at(rig, FAILS_S, lambda: monkeypatch.setattr(rig.controller._walker, "target", lambda *_: None))
    assert rig.controller.run() is Fault.TARGET_LOST
    assert rig.log.states == [*UP, State.HOLDING, State.LYING_DOWN, State.DAMPING]


def test_an_error_of_the_program_ends_in_lying_down_and_damping(shipped, monkeypatch):
    rig = Rig(shipped, SCRIPT)

    def bug(*_):
        raise ZeroDivisionError

    _at(rig, FAILS_S, lambda: monkeypatch.setattr(rig.controller._walker, "target", bug))
    with pytest.raises(ZeroDivisionError):
        rig.controller.run()
    assert rig.controller.machine.state is State.DAMPING and rig.rests_on_its_legs()


def test_a_target_beyond_the_limits_ends_in_lying_down_and_damping(shipped, monkeypatch):
    rig = Rig(shipped, SCRIPT)
    wild = np.full(12, 9.0, np.float32)
    _at(rig, FAILS_S, lambda: monkeypatch.setattr(rig.controller._walker, "target", lambda *_: wild))
    assert rig.controller.run() is Fault.TARGET_LIMIT
    assert rig.log.states == [*UP, State.LYING_DOWN, State.DAMPING]


def test_the_operators_stop_ends_in_damping_at_once(shipped):
    rig = Rig(shipped, f"{SCRIPT}, {FAILS_S} stop")
    assert rig.controller.run() is Fault.OPERATOR
    assert rig.log.states == [*UP, State.DAMPING]


def test_a_first_interrupt_lays_down_and_a_second_one_damps(shipped):
    gentle, hard = Rig(shipped, SCRIPT), Rig(shipped, SCRIPT)
    _at(gentle, 1.0, gentle.controller.interrupt)
    assert gentle.controller.run() is None and gentle.log.states[-2:] == [State.LYING_DOWN, State.PASSIVE]
    _at(hard, 1.0, lambda: (hard.controller.interrupt(), hard.controller.interrupt()))
    assert hard.controller.run() is Fault.OPERATOR


def test_commands_that_fail_for_good_lay_the_robot_down_by_its_own_watchdog(shipped):
    rig = Rig(shipped, QUITS, Setup(commands=Conditions(outage_at_s=FAILS_S, outage_s=np.inf), hold_s=0.1))
    rig.controller.run()
    assert rig.plant.watchdog.acted
    assert rig.plant.robot.height < 0.2 and rig.plant.robot.tilt < 1.0


@pytest.mark.parametrize(
    "setup",
    [
        Setup(commands=Conditions(outage_at_s=FAILS_S, outage_s=0.08), hold_s=0.1),
        Setup(states=Conditions(outage_at_s=FAILS_S, outage_s=0.06)),
        Setup(commands=Conditions(loss=0.05), states=Conditions(loss=0.05), hold_s=0.1),
        Setup(commands=Conditions(delay_s=0.005), hold_s=0.1),
    ],
    ids=["commands fail briefly", "states fail briefly", "messages are lost", "commands are late"],
)
def test_small_disturbances_are_walked_through(shipped, setup):
    rig = Rig(shipped, QUITS, setup)
    assert rig.controller.run() is None
    assert rig.log.states[-2:] == [State.LYING_DOWN, State.PASSIVE]
    assert rig.plant.record()["tilt_rad"].max() < 0.8 and not rig.plant.watchdog.acted


def _at(rig: Rig, time_s: float, event) -> None:
    """Let something happen when the plant's time has come."""
    poll, done = rig.controller._desk.input.poll, []

    def polled(now_s, newest, wanted):
        if now_s >= time_s and not done:
            done.append(event())
        return poll(now_s, newest, wanted)

    rig.controller._desk.input.poll = polled  # type: ignore[method-assign]


def _spin(rig: Rig) -> None:
    """Throw the robot onto its side."""
    rig.plant.robot.data.qvel[2:4] = [1.5, 8.0]
