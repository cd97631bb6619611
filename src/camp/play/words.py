"""Texts that are made from the policy's names and numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from camp.gaits.skills import split_name


@dataclass(frozen=True)
class Command:
    """One number of the command. key: in the metadata's command_range."""

    key: str
    title: str
    unit: str
    positive: str  # what a value above 0 means


COMMANDS = (
    Command("vx_m_s", "vx", "m/s", "forward"),
    Command("vy_m_s", "vy", "m/s", "to the left"),
    Command("yaw_rate_rad_s", "yaw", "rad/s", "to the left"),
)


def spoken(name: str) -> str:
    """A gait's name such as "slow_walk" as "Slow walk"."""
    return name.replace("_", " ").capitalize()


def skill_text(name: str) -> str:
    """A skill's name such as "trot_2hz" as "Trot, 2 strides/s"."""
    gait, frequency_hz = split_name(name)
    return spoken(gait) if frequency_hz is None else f"{spoken(gait)}, {frequency_hz:g} strides/s"


def number(value: float, digits: int = 2) -> str:
    """A number, or a dash where there is none."""
    return "–" if value != value else f"{value:.{digits}f}"


def numbers(values: Sequence[float] | None) -> list[str]:
    """One text for each of COMMANDS; dashes where nothing was measured."""
    return ["–"] * len(COMMANDS) if values is None else [f"{value:+.2f}" for value in values]
