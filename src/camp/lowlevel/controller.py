"""The control loop of a robot: newest reading, operator, states, policy, command, log."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

from camp.lowlevel.message_log import MessageLog, Row
from camp.lowlevel.messages import Array, Reading
from camp.lowlevel.operator import Input, Order, Wanted
from camp.lowlevel.pace import Beat, Pace
from camp.lowlevel.remote import Remote
from camp.lowlevel.state_machine import Fault, State, StateMachine, Wish
from camp.lowlevel.transport import RobotLink
from camp.lowlevel.walker import Walker

LAST_S = 3.0  # that damping is sent, before the program ends


@dataclass
class Desk:
    """Where the operator sits: what he asks with, what holds, and what is written down."""

    input: Input
    wanted: Wanted
    log: MessageLog


class Controller:
    """One robot and one policy, until the operator quits or a fault has ended in damping."""

    def __init__(self, link: RobotLink, walker: Walker, pace: Pace, desk: Desk):
        self.machine = StateMachine(walker.body())
        self._link, self._walker, self._pace, self._desk = link, walker, pace, desk
        self._newest: Reading | None = None
        self._came_s = -math.inf
        self._quits = False
        self._interrupts = 0
        self._answers = 0  # the step that is under way, in lockstep
        self._begun_s: float | None = None  # of the first change that was printed

    def interrupt(self) -> None:
        """Ctrl-C and its like: the first one lays the robot down, the second one damps it at once."""
        self._interrupts += 1

    def run(self) -> Fault | None:
        """Control the robot; returns the fault that ended it, or None.

        Where this program itself fails, the robot is laid down and damped before the error goes on.
        """
        try:
            while not self._over():
                self._step()
        except BaseException:
            self._end_blind()
            raise
        return self.machine.fault

    def _end_blind(self) -> None:
        """As after a lost state: nothing else of this program is relied on."""
        self._quits = True
        self._link.send(replace(self.machine.command(), step=self._answers))  # in lockstep the robot waits for it
        while not self._over():
            beat = self._pace.next(self._link)
            self.machine.watch(beat.now_s, None, math.inf)
            self._link.send(replace(self.machine.command(), step=beat.step))

    def _over(self) -> bool:
        state = self.machine.state
        quiet = state is State.PASSIVE and self._quits
        return quiet or (state is State.DAMPING and self.machine.elapsed() >= LAST_S)

    def _step(self) -> None:
        beat, machine = self._pace.next(self._link), self.machine
        begun, before = time.perf_counter(), machine.state
        self._answers = beat.step
        fresh = self._note(beat)
        order = self._order(beat.now_s)
        self._desk.wanted.take(order)
        self._quits |= order.quit
        age = beat.now_s - self._came_s
        machine.watch(beat.now_s, self._newest, age, order.wish, self._link.rival())
        if machine.state is State.WALKING and before is State.STANDING:
            self._walker.start()
        command = machine.command(self._target() if fresh and machine.asks_policy else None)
        self._link.send(replace(command, step=beat.step))
        if machine.state is not before:
            self._tell(beat.now_s)
        self._desk.log.add(
            Row(
                now_s=beat.now_s,
                state=machine.state,
                fault=machine.fault.name if machine.fault else "",
                skill=self._desk.wanted.skill,
                late_ms=beat.late_s * 1e3,
                work_ms=(time.perf_counter() - begun) * 1e3,
                robot_ms=self._newest.time_ms if self._newest else -1,
                age_ms=age * 1e3 if self._newest else 0.0,
                fresh=int(fresh),
            )
        )

    def _note(self, beat: Beat) -> bool:
        """Keep the newest reading; whether it is a new one.

        In lockstep a lost one is sent once more. Otherwise all that comes is new: Unitree's simulator has no clock.
        """
        came, known = beat.reading, self._newest
        if came is None or (beat.step > 0 and known is not None and came.time_ms == known.time_ms):
            return False
        self._newest, self._came_s = came, beat.now_s
        return True

    def _order(self, now_s: float) -> Order:
        if self._interrupts:
            return Order(wish=Wish.LIE if self._interrupts == 1 else Wish.STOP, quit=True)
        if self._newest is not None and Remote.unpack(self._newest.remote).stops:
            return Order(wish=Wish.STOP)
        return self._desk.input.poll(now_s, self._newest, self._desk.wanted)

    def _target(self) -> Array | None:
        if self._newest is None:
            return None
        return self._walker.target(self._newest, self._desk.wanted.skill, self._desk.wanted.velocity)

    def _tell(self, now_s: float) -> None:
        self._begun_s = now_s if self._begun_s is None else self._begun_s
        fault = f" ({self.machine.fault})" if self.machine.fault else ""
        print(f"{now_s - self._begun_s:8.2f} s  {self.machine.state}{fault}", flush=True)
