"""What the robot may do next: the states between lying, standing and walking, and how each fault ends.

Nothing here knows of DDS, clocks or engines: `watch` is told the time and the newest reading, `command` answers with
what the motors do. A fault is latched: its state is left by starting the program again.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from camp.lowlevel.messages import Array, Command, Reading
from camp.lowlevel.motion import DROP_S, LIE_S, Way, damping, lie_down, stand_up

LARGEST_TILT = 0.8  # rad: where episodes of training end
STATE_LOST_S = 0.1  # without a new reading
HOLD_S = 0.1  # that the last target is held without a new one; docs/go2.md has the measurement
TARGET_MARGIN = 0.4  # rad beyond a joint's range; docs/go2.md has the policy's largest
FOLLOWED = 0.5  # rad, between a joint that stands and its target


class State(StrEnum):
    """What the motors do."""

    PASSIVE = "passive"  # damping, until it is told to stand up
    STANDING_UP = "standing up"
    STANDING = "standing"
    WALKING = "walking"  # the policy's targets
    HOLDING = "holding"  # the last target, for want of a new one
    LYING_DOWN = "lying down"
    DAMPING = "damping"  # the end


class Fault(StrEnum):
    """Why the robot was stopped, and whether it lies down first or is damped at once."""

    TILT = "the trunk tilted too far: damped at once"
    RIVAL = "another process commands the motors: damped at once"
    OPERATOR = "the operator stopped it: damped at once"
    STATE_LOST = "no reading of the robot's state came: lay down, then damped"
    TARGET_LOST = "the policy gave no target: lay down, then damped"
    TARGET_LIMIT = "a target of the policy was beyond the joint's limits: lay down, then damped"
    NOT_FOLLOWED = "the joints did not follow the way up: lay down, then damped"


AT_ONCE = (Fault.TILT, Fault.RIVAL, Fault.OPERATOR)


class Wish(StrEnum):
    """What the operator asks for."""

    STAND = "stand"
    WALK = "walk"
    LIE = "lie"
    STOP = "stop"  # damping at once


@dataclass(frozen=True)
class Body:
    """What the states need of robot and policy; (12,) each, in the order of JOINT_NAMES."""

    pose: Array  # rad, in which it stands
    kp: Array  # N m/rad, the policy's
    kd: Array  # N m s/rad
    lower: Array  # rad, of the joints' ranges
    upper: Array  # rad


class StateMachine:
    """One robot, from passive to passive or to damping."""

    def __init__(self, body: Body):
        self.state = State.PASSIVE
        self.fault: Fault | None = None
        self._body = body
        self._way: Way | None = None
        self._since = 0.0  # s, when the state began
        self._now = 0.0
        self._last = damping()

    @property
    def asks_policy(self) -> bool:
        """Whether the next command is the policy's."""
        return self.state in (State.WALKING, State.HOLDING)

    def elapsed(self) -> float:
        """Seconds since the state began."""
        return self._now - self._since

    def watch(
        self, now_s: float, reading: Reading | None, age_s: float, wish: Wish | None = None, rival: bool = False
    ) -> None:
        """Look at the newest reading, ``age_s`` old, and at what the operator wishes, and choose the state.

        now_s: any clock that never runs backwards. rival: somebody else's command was seen.
        """
        self._now = now_s
        fresh = reading if age_s <= STATE_LOST_S else None
        self._look_for_faults(fresh, rival or wish is Wish.STOP, rival)
        self._follow(wish, fresh)
        if self._way is not None and self.elapsed() >= self._way.seconds:
            self._arrive(fresh)

    def command(self, target: Array | None = None) -> Command:
        """What the motors do in this step. target: the policy's, (12,) rad; None where it has none."""
        if self.asks_policy:
            self._judge_target(target)
        if self.state is State.WALKING and target is not None:
            self._last = Command(target, self._body.kp, self._body.kd)
        elif self.state in (State.PASSIVE, State.DAMPING):
            self._last = damping()
        elif self._way is not None:
            self._last = self._way.at(self.elapsed())
        return self._last

    def _look_for_faults(self, fresh: Reading | None, stop: bool, rival: bool) -> None:
        if self.state is State.DAMPING:
            return
        if stop:
            self._fail(Fault.RIVAL if rival else Fault.OPERATOR)
        elif self.state is State.PASSIVE:
            return
        elif fresh is None:
            self._fail(Fault.STATE_LOST)
        elif fresh.tilt > LARGEST_TILT:
            self._fail(Fault.TILT)

    def _follow(self, wish: Wish | None, fresh: Reading | None) -> None:
        upright = fresh is not None and fresh.tilt <= LARGEST_TILT
        if wish is Wish.STAND and self.state is State.PASSIVE and fresh is not None and upright:
            self._go(State.STANDING_UP, stand_up(fresh, self._body.pose, self._body.kp, self._body.kd))
        elif wish is Wish.WALK and self.state is State.STANDING:
            self._go(State.WALKING)
        elif wish is Wish.LIE and self.state not in (State.PASSIVE, State.LYING_DOWN, State.DAMPING):
            self._lie_down()

    def _arrive(self, fresh: Reading | None) -> None:
        if self.state is State.LYING_DOWN:
            self._go(State.DAMPING if self.fault else State.PASSIVE)
        elif self.state is State.STANDING_UP:
            if fresh is not None and np.abs(fresh.joint_position - self._body.pose).max() > FOLLOWED:
                self._fail(Fault.NOT_FOLLOWED)
            else:
                self._go(State.STANDING, self._way)

    def _judge_target(self, target: Array | None) -> None:
        if target is None:
            if self.state is State.WALKING:
                self._go(State.HOLDING)
            elif self.elapsed() > HOLD_S:
                self._fail(Fault.TARGET_LOST)
        elif not self._within(target):
            self._fail(Fault.TARGET_LIMIT)
        elif self.state is State.HOLDING:
            self._go(State.WALKING)

    def _within(self, target: Array) -> bool:
        lower, upper = self._body.lower - TARGET_MARGIN, self._body.upper + TARGET_MARGIN
        return bool(((lower <= target) & (target <= upper)).all())  # False where it is no number

    def _fail(self, fault: Fault) -> None:
        """Latch the first fault; a later one counts where it ends the lying down."""
        if fault in AT_ONCE:
            self.fault = self.fault or fault
            self._go(State.DAMPING)
        elif self.fault is None:
            self.fault = fault
            if self.state is not State.LYING_DOWN:
                self._lie_down()

    def _lie_down(self) -> None:
        self._go(State.LYING_DOWN, lie_down(self._last, DROP_S if self.asks_policy else LIE_S))

    def _go(self, state: State, way: Way | None = None) -> None:
        if state is not State.STANDING:  # which stays at the end of the way up
            self._since = self._now
        self.state, self._way = state, way
