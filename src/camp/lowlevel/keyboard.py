"""The terminal's keys as orders."""

from __future__ import annotations

import os
import select
import sys
import termios
import tty
from collections.abc import Iterator
from contextlib import contextmanager

from camp.common.errors import CampError
from camp.lowlevel.messages import Reading
from camp.lowlevel.operator import STILL, Order, Velocity, Wanted
from camp.lowlevel.state_machine import Wish

HELP = (
    "u stand up   g walk   l lie down   space STOP (damping at once)   q lie down and quit\n"
    "w s forward, back   a d turn   z c sideways   x stand still   1-9 0 - = skill"
)
SKILLS = tuple("1234567890-=")  # the upper row of a keyboard
WISHES = {"u": Wish.STAND, "g": Wish.WALK, "l": Wish.LIE, " ": Wish.STOP}
STEPS: dict[str, Velocity] = {
    "w": (0.1, 0.0, 0.0),
    "s": (-0.1, 0.0, 0.0),
    "z": (0.0, 0.05, 0.0),
    "c": (0.0, -0.05, 0.0),
    "a": (0.0, 0.0, 0.1),
    "d": (0.0, 0.0, -0.1),
}


def order_of_key(key: str, wanted: Wanted) -> Order:
    """What one key asks for; nothing where it has no meaning."""
    if key in WISHES:
        return Order(wish=WISHES[key])
    if key == "q":
        return Order(wish=Wish.LIE, quit=True)
    if key == "x":
        return Order(velocity=STILL)
    if key in STEPS:
        vx, vy, wz = (round(old + step, 3) for old, step in zip(wanted.velocity, STEPS[key], strict=True))
        return Order(velocity=(vx, vy, wz))
    if key in SKILLS[: len(wanted.skills)]:
        return Order(skill=wanted.skills[SKILLS.index(key)])
    return Order()


class Keyboard:
    """Keys as they are pressed. A terminal that is gone lays the robot down."""

    def __init__(self, descriptor: int):
        self._descriptor = descriptor
        self._gone = False

    def poll(self, now_s: float, reading: Reading | None, wanted: Wanted) -> Order:
        """The next key's order."""
        while not self._gone and select.select([self._descriptor], [], [], 0)[0]:
            key = os.read(self._descriptor, 1)
            self._gone = not key
            order = order_of_key(key.decode(errors="replace"), wanted)
            if order != Order():
                return order
        return Order(wish=Wish.LIE, quit=True) if self._gone else Order()


@contextmanager
def keyboard() -> Iterator[Keyboard]:
    """The terminal's keyboard, without echo. Raises CampError where there is no terminal."""
    if not sys.stdin.isatty():
        raise CampError("--input keyboard: standard input is no terminal; give --input remote, or --script")
    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)
    try:
        tty.setcbreak(descriptor)
        print(HELP)
        yield Keyboard(descriptor)
    finally:
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
