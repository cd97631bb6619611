"""Orders by a clock: for tests, demonstrations and measurements that can be repeated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import cast

from camp.common.errors import CampError
from camp.lowlevel.messages import Reading
from camp.lowlevel.operator import Order, Velocity, Wanted
from camp.lowlevel.state_machine import Wish

EXAMPLE = "0 stand, 4 walk, 4 velocity 0.5 0 0, 8 skill pace_2hz, 12 quit"


def read_script(text: str, skills: Sequence[str]) -> list[tuple[float, Order]]:
    """Entries ``<second> <what>``, separated by commas, in order of time. Raises CampError, naming the entry.

    What: stand, walk, lie, stop, quit, ``skill <name>`` or ``velocity <vx> <vy> <yaw rate>``.
    """
    entries = []
    for entry in text.split(","):
        at, *words = entry.split() or [""]
        try:
            entries.append((_number(at), _order(words, skills)))
        except ValueError as error:
            raise CampError(f"--script {entry.strip()!r}: {error}; write it as {EXAMPLE!r}") from error
    return sorted(entries, key=lambda entry: entry[0])


def _order(words: Sequence[str], skills: Sequence[str]) -> Order:
    match words:
        case ["skill", name]:
            if name not in skills:
                raise ValueError(f"the policy's skills are {', '.join(skills)}")
            return Order(skill=name)
        case ["velocity", _, _, _]:
            return Order(velocity=cast(Velocity, tuple(map(_number, words[1:]))))
        case ["quit"]:
            return Order(wish=Wish.LIE, quit=True)
        case [word]:
            return Order(wish=Wish(word))
    raise ValueError("not understood")


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError("not a finite number")
    return value


class Script:
    """A script as input; its times count from the first control step."""

    def __init__(self, entries: Sequence[tuple[float, Order]]):
        self._entries = list(entries)
        self._begin: float | None = None

    def poll(self, now_s: float, reading: Reading | None, wanted: Wanted) -> Order:
        """The next entry whose time has come."""
        self._begin = now_s if self._begin is None else self._begin
        if self._entries and now_s - self._begin >= self._entries[0][0] - 1e-9:
            return self._entries.pop(0)[1]
        return Order()
