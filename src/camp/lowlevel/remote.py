"""The Go2's wireless remote, whose state comes with every LowState: 40 bytes, of which 2 to 23 are used.

Bytes 2 and 3 are 16 buttons, 4 to 15 and 20 to 23 four sticks as little-endian floats from -1 to 1: lx, rx, ry, ly.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

from camp.lowlevel.messages import REMOTE_BYTES, Reading
from camp.lowlevel.operator import Order, Velocity, Wanted
from camp.lowlevel.state_machine import Wish

BUTTONS = ("R1", "L1", "start", "select", "R2", "L2", "F1", "F2", "A", "B", "X", "Y", "up", "right", "down", "left")
DEAD_ZONE = 0.1  # of a stick that is let go
HELP = (
    "start: stand up   A: walk   B: lie down   L2 + B: STOP (damping at once)   select: lie down and quit\n"
    "left stick: forward, sideways   right stick: turn   left, right on the cross: skill"
)
_LAYOUT = struct.Struct("<2xH3f4xf16x")
assert _LAYOUT.size == REMOTE_BYTES


@dataclass(frozen=True)
class Remote:
    """Buttons that are down, and the sticks, right and up being positive."""

    pressed: frozenset[str] = frozenset()
    lx: float = 0.0
    rx: float = 0.0
    ry: float = 0.0
    ly: float = 0.0

    @classmethod
    def unpack(cls, data: bytes) -> Remote:
        """From LowState's 40 bytes. A stick that is no number counts as let go."""
        keys, *sticks = _LAYOUT.unpack(data)
        pressed = frozenset(name for bit, name in enumerate(BUTTONS) if keys >> bit & 1)
        return cls(pressed, *(stick if math.isfinite(stick) else 0.0 for stick in sticks))

    def pack(self) -> bytes:
        """LowState's 40 bytes."""
        keys = sum(1 << bit for bit, name in enumerate(BUTTONS) if name in self.pressed)
        return _LAYOUT.pack(keys, self.lx, self.rx, self.ry, self.ly)

    @property
    def stops(self) -> bool:
        """Whether Unitree's own combination for damping is pressed."""
        return {"L2", "B"} <= self.pressed


class RemoteInput:
    """The remote as orders: buttons when they go down, sticks as shares of the velocity's range."""

    def __init__(self) -> None:
        self._before = Remote()

    def poll(self, now_s: float, reading: Reading | None, wanted: Wanted) -> Order:
        """What the remote asks for now."""
        if reading is None:
            return Order()
        now = Remote.unpack(reading.remote)
        new = now.pressed - self._before.pressed
        self._before = now
        velocity = _velocity(now, wanted)
        if "select" in new:
            return Order(wish=Wish.LIE, velocity=velocity, quit=True)
        wishes = {"start": Wish.STAND, "A": Wish.WALK, "B": Wish.LIE}
        wish = next((wishes[name] for name in ("B", "start", "A") if name in new), None)
        turn = ("right" in new) - ("left" in new)
        return Order(wish, wanted.neighbour(turn) if turn else None, velocity)


def _velocity(remote: Remote, wanted: Wanted) -> Velocity:
    shares = (remote.ly, -remote.lx, -remote.rx)  # left is positive here
    vx, vy, wz = (_share(share, low, high) for share, (low, high) in zip(shares, wanted.ranges, strict=True))
    return vx, vy, wz


def _share(share: float, low: float, high: float) -> float:
    if abs(share) < DEAD_ZONE:
        return 0.0
    return share * high if share > 0 else -share * low
