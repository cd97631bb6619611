"""Every transition of the states, and where each fault ends, without robot, clock or policy."""

from __future__ import annotations

import numpy as np
import pytest

from camp.lowlevel.messages import Command
from camp.lowlevel.motion import FOLDED
from camp.lowlevel.state_machine import (
    HOLD_S,
    STATE_LOST_S,
    TARGET_MARGIN,
    Body,
    Fault,
    State,
    StateMachine,
    Wish,
)
from tests.lowlevel.rig import joints, reading

STEP = 0.02
POSE = np.array([0.0, 0.9, -1.8] * 4, np.float32)
BODY = Body(POSE, joints(30.0), joints(1.0), POSE - 1.0, POSE + 1.0)


class Session:
    """A machine, told a time step by step. The robot follows every target at once."""

    def __init__(self) -> None:
        self.machine = StateMachine(BODY)
        self.now, self.age = 0.0, 0.0
        self.position, self.tilt = FOLDED, 0.0
        self.command = Command(joints(0.0), joints(0.0), joints(0.0))

    def step(self, wish: Wish | None = None, target=POSE, rival: bool = False, blind: bool = False) -> State:
        """One control step; ``blind``: without a new reading, hence without a target."""
        self.now += STEP
        self.age = self.age + STEP if blind else 0.0
        self.machine.watch(self.now, reading(tilt=self.tilt, position=self.position), self.age, wish, rival)
        self.command = self.machine.command(None if blind else target)
        if self.command.kp.any():
            self.position = self.command.target
        return self.machine.state

    def run(self, seconds: float, **each) -> State:
        for _ in range(round(seconds / STEP)):
            self.step(**each)
        return self.machine.state

    def upto(self, state: State) -> Session:
        """Bring the robot into a state."""
        wishes = {State.STANDING_UP: Wish.STAND, State.STANDING: Wish.STAND, State.WALKING: Wish.STAND}
        self.step(wishes.get(state))
        if state in (State.STANDING, State.WALKING):
            self.run(4.0)
        if state is State.WALKING:
            self.step(Wish.WALK)
        assert self.machine.state is state
        return self

    def ends(self) -> list[State]:
        """The states from now to the end, the robot being left alone."""
        found = [self.machine.state]
        for _ in range(500):
            if self.step() is not found[-1]:
                found.append(self.machine.state)
        return found


MOVING = [State.STANDING_UP, State.STANDING, State.WALKING]


def test_the_usual_way_leads_from_passive_to_passive():
    session = Session()
    assert session.step() is State.PASSIVE and not session.command.kp.any()
    assert session.step(Wish.WALK) is State.PASSIVE  # not from the ground
    assert session.step(Wish.STAND) is State.STANDING_UP
    assert session.run(4.0) is State.STANDING
    np.testing.assert_allclose(session.command.target, POSE, atol=1e-6)
    assert session.step(Wish.WALK, target=POSE + 0.1) is State.WALKING
    np.testing.assert_array_equal(session.command.target, POSE + np.float32(0.1))
    assert (session.command.kp == BODY.kp).all()
    assert session.step(Wish.LIE) is State.LYING_DOWN
    assert session.ends() == [State.LYING_DOWN, State.PASSIVE]
    assert session.machine.fault is None
    assert session.step(Wish.STAND) is State.STANDING_UP  # once more


@pytest.mark.parametrize("state", MOVING)
@pytest.mark.parametrize(
    ("fault", "step"),
    [(Fault.RIVAL, {"rival": True}), (Fault.OPERATOR, {"wish": Wish.STOP})],
)
def test_a_rival_and_the_operators_stop_damp_at_once(state, fault, step):
    session = Session().upto(state)
    assert session.step(**step) is State.DAMPING and session.machine.fault is fault
    assert not session.command.kp.any() and session.command.kd.all()


@pytest.mark.parametrize("state", MOVING)
def test_tilt_damps_at_once(state):
    session = Session().upto(state)
    session.tilt = 0.9
    assert session.step() is State.DAMPING and session.machine.fault is Fault.TILT


def test_tilt_while_lying_down_damps_at_once():
    session = Session().upto(State.WALKING)
    session.step(Wish.LIE)
    session.tilt = 0.9
    assert session.step() is State.DAMPING and session.machine.fault is Fault.TILT


@pytest.mark.parametrize("state", MOVING)
def test_a_lost_state_lays_the_robot_down_without_a_reading(state):
    session = Session().upto(state)
    for _ in range(round(STATE_LOST_S / STEP) - 1):
        assert session.step(blind=True) is (State.HOLDING if state is State.WALKING else state)
    session.run(2 * STEP, blind=True)
    assert session.machine.state is State.LYING_DOWN and session.machine.fault is Fault.STATE_LOST
    assert session.run(0.8, blind=True) is State.LYING_DOWN and session.command.kp.all()
    assert session.run(2.0, blind=True) is State.DAMPING
    np.testing.assert_allclose(session.position, FOLDED, atol=0.02)


def test_a_lost_target_is_held_briefly_and_walking_goes_on():
    session = Session().upto(State.WALKING)
    session.step(target=POSE + 0.2)
    assert session.step(target=None) is State.HOLDING
    np.testing.assert_array_equal(session.command.target, POSE + np.float32(0.2))
    assert session.step() is State.WALKING and session.machine.fault is None


def test_targets_that_stay_away_lay_the_robot_down():
    session = Session().upto(State.WALKING)
    assert session.run(HOLD_S, target=None) is State.HOLDING
    session.run(2 * STEP, target=None)
    assert session.machine.fault is Fault.TARGET_LOST
    assert session.ends() == [State.LYING_DOWN, State.DAMPING]


@pytest.mark.parametrize("beyond", [1.01 + TARGET_MARGIN, -1.01 - TARGET_MARGIN, np.nan])
def test_a_target_beyond_the_limits_is_not_sent(beyond):
    session = Session().upto(State.WALKING)
    session.step(target=POSE + 0.1)
    session.step(target=POSE + np.eye(12, dtype=np.float32)[4] * np.float32(beyond))
    assert session.machine.fault is Fault.TARGET_LIMIT
    np.testing.assert_array_equal(session.command.target, POSE + np.float32(0.1))
    assert session.ends() == [State.LYING_DOWN, State.DAMPING]


def test_joints_that_do_not_follow_lay_the_robot_down():
    session = Session().upto(State.STANDING_UP)
    for _ in range(200):
        session.position = FOLDED
        session.step()
    assert session.machine.fault is Fault.NOT_FOLLOWED and session.machine.state is State.LYING_DOWN


def test_the_first_fault_is_kept_and_no_wish_leaves_damping():
    session = Session().upto(State.WALKING)
    session.run(0.2, blind=True)
    assert session.ends() == [State.LYING_DOWN, State.DAMPING]
    for wish in (Wish.STAND, Wish.WALK, Wish.LIE, Wish.STOP):
        assert session.step(wish) is State.DAMPING
    assert session.step(rival=True) is State.DAMPING
    assert session.machine.fault is Fault.STATE_LOST


def test_the_robot_does_not_stand_up_blind_or_tilted():
    session = Session()
    session.age = 1.0
    assert session.step(Wish.STAND, blind=True) is State.PASSIVE
    session.tilt = 0.9
    assert session.step(Wish.STAND) is State.PASSIVE and session.machine.fault is None


def test_a_rival_is_a_fault_even_before_standing_up():
    session = Session()
    assert session.step(rival=True) is State.DAMPING and session.machine.fault is Fault.RIVAL
