"""Checks of configuration values; each failure is one line with the key, the value and the remedy.

The range of a single number stands in its type: `camp.common.bounds`.
"""

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


def place(key: str, value: str | None) -> None:
    """A file or a folder, or None for the default one."""
    require(
        value is None or bool(value.strip()), key, value, "name a place, or leave it out (an unset shell variable?)"
    )


def layers(key: str, sizes: Sequence[int]) -> None:
    require(len(sizes) > 0, key, list(sizes), "list one or more layer sizes")


def interval(key: str, value: Sequence[float]) -> None:
    """[low, high], low <= high."""
    low_high = list(value)
    require(len(low_high) == 2 and low_high[0] <= low_high[1], key, low_high, "give [low, high] with low <= high")
