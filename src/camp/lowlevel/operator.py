"""What the operator wants: a state, a skill and a velocity, from whatever he holds in his hands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from camp.lowlevel.messages import Reading
from camp.lowlevel.state_machine import Wish

Velocity = tuple[float, float, float]  # vx, vy in m/s, yaw rate in rad/s
STILL: Velocity = (0.0, 0.0, 0.0)
RANGE_NAMES = ("vx_m_s", "vy_m_s", "yaw_rate_rad_s")


@dataclass(frozen=True)
class Order:
    """What an input asks for in one control step; None: nothing new."""

    wish: Wish | None = None
    skill: str | None = None
    velocity: Velocity | None = None
    quit: bool = False  # lie down, then end the program


class Input(Protocol):
    """Keyboard, wireless remote, or a script."""

    def poll(self, now_s: float, reading: Reading | None, wanted: Wanted) -> Order:
        """What is asked for now. wanted: what holds so far."""
        ...


@dataclass
class Wanted:
    """Skill and velocity that hold until others are asked for."""

    skills: Sequence[str]
    ranges: Sequence[tuple[float, float]]  # of the velocity's three numbers
    skill: str
    velocity: Velocity = STILL

    @classmethod
    def of(cls, metadata: Mapping[str, object], skill: str | None) -> Wanted:
        """Of a policy's metadata. skill: the first one; None: the policy's first."""
        skills: Sequence[str] = metadata["skills"]  # type: ignore[assignment]
        given: Mapping[str, Sequence[float]] = metadata.get("command_range") or {}  # type: ignore[assignment]
        ranges = [(given[name][0], given[name][1]) if name in given else (0.0, 0.0) for name in RANGE_NAMES]
        return cls(skills, ranges, skill or skills[0])

    def take(self, order: Order) -> None:
        """Follow an order; the velocity is kept within what the policy was trained on."""
        self.skill = order.skill or self.skill
        if order.velocity is not None:
            vx, vy, wz = (
                min(max(value, low), high) for value, (low, high) in zip(order.velocity, self.ranges, strict=True)
            )
            self.velocity = (vx, vy, wz)

    def neighbour(self, step: int) -> str:
        """The skill so many places further in the policy's list."""
        return self.skills[(self.skills.index(self.skill) + step) % len(self.skills)]
