"""What happens to messages on their way: loss, delay, an outage."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from camp.common.errors import CampError

Message = TypeVar("Message")
_SLACK = 1e-9  # s, of times that are sums of steps


@dataclass(frozen=True)
class Conditions:
    """Of one direction. Raises CampError for what cannot be."""

    loss: float = 0.0  # share of the messages, drawn independently
    delay_s: float = 0.0
    outage_at_s: float = math.inf  # no message gets through from here
    outage_s: float = 0.0  # for so long

    def __post_init__(self) -> None:
        if not 0.0 <= self.loss <= 1.0:
            raise CampError(f"loss {self.loss:g}: give a share between 0 and 1")
        if not (0.0 <= self.delay_s < math.inf and self.outage_at_s >= 0.0 and self.outage_s >= 0.0):
            raise CampError(f"delay {self.delay_s:g} s, outage {self.outage_s:g} s: give times of 0 or more")


class Channel(Generic[Message]):
    """One direction: messages go in when they are sent and come out when they arrive."""

    def __init__(self, conditions: Conditions, seed: int):
        self._conditions = conditions
        self._random = np.random.default_rng(seed)
        self._under_way: deque[tuple[float, Message]] = deque()
        self.sent = self.lost = 0

    def put(self, now_s: float, message: Message) -> None:
        """Send a message."""
        self.sent += 1
        begin, end = self._conditions.outage_at_s, self._conditions.outage_at_s + self._conditions.outage_s
        if self._random.random() < self._conditions.loss or begin - _SLACK <= now_s < end - _SLACK:
            self.lost += 1
        else:
            self._under_way.append((now_s + self._conditions.delay_s, message))

    def get(self, now_s: float) -> Message | None:
        """The newest message that has arrived since the last call; None where none has."""
        newest = None
        while self._under_way and self._under_way[0][0] <= now_s + _SLACK:
            newest = self._under_way.popleft()[1]
        return newest
