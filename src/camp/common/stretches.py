"""Stretches of equal values in a sequence."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TypeVar

T = TypeVar("T")


def stretches(values: Sequence[T]) -> list[tuple[int, int, T]]:
    """Begin, end (exclusive) and value of each stretch of equal values."""
    bounds = [0, *(i for i in range(1, len(values)) if values[i] != values[i - 1]), len(values)]
    return [(begin, end, values[begin]) for begin, end in pairwise(bounds) if end > begin]
