"""Range checks of configuration values; each failure is one line with the key, the value and the remedy."""

from __future__ import annotations

import math
from collections.abc import Sequence

from camp.common.errors import ConfigError


def require(holds: bool, key: str, value: object, remedy: str) -> None:
    """Raise ConfigError unless ``holds``."""
    if not holds:
        raise ConfigError(f"{key} = {value!r}: {remedy}")


def positive(key: str, value: float) -> None:
    require(0.0 < value < math.inf, key, value, "choose a finite number above 0")


def not_negative(key: str, value: float) -> None:
    require(0.0 <= value < math.inf, key, value, "choose a finite number of 0 or more")


def seed(key: str, value: int) -> None:
    # torch takes no more than 64 bits.
    require(0 <= value < 2**64, key, value, "choose a whole number from 0 to 2^64 - 1")


def place(key: str, value: str | None) -> None:
    """A file or a folder, or None for the default one."""
    require(
        value is None or bool(value.strip()), key, value, "name a place, or leave it out (an unset shell variable?)"
    )


def finite(key: str, value: float) -> None:
    require(math.isfinite(value), key, value, "choose a finite number")


def fraction(key: str, value: float) -> None:
    require(0.0 <= value <= 1.0, key, value, "choose a fraction in [0, 1]")


def fraction_below_one(key: str, value: float) -> None:
    require(0.0 <= value < 1.0, key, value, "choose a fraction in [0, 1)")


def layers(key: str, sizes: Sequence[int]) -> None:
    require(len(sizes) > 0 and all(s >= 1 for s in sizes), key, list(sizes), "list one or more layer sizes >= 1")


def count(key: str, value: int) -> None:
    require(value >= 1, key, value, "choose a whole number of 1 or more")


def interval(key: str, value: Sequence[float]) -> None:
    """[low, high], finite, low <= high."""
    low_high = list(value)
    holds = len(low_high) == 2 and all(map(math.isfinite, low_high)) and low_high[0] <= low_high[1]
    require(holds, key, low_high, "give [low, high] with low <= high")


def not_negative_interval(key: str, value: Sequence[float]) -> None:
    """As ``interval``, with low >= 0."""
    interval(key, value)
    require(value[0] >= 0.0, key, list(value), "give [low, high] with low >= 0")


def positive_interval(key: str, value: Sequence[float]) -> None:
    """As ``interval``, with low > 0."""
    interval(key, value)
    require(value[0] > 0.0, key, list(value), "give [low, high] with low > 0")
