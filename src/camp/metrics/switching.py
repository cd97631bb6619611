"""How quickly and how smoothly one gait gives way to another. Pure numpy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


def fraction_within(seconds: Array, limit_s: float) -> float | None:
    """Fraction of the switches (M,) that took at most ``limit_s`` s; nan means never. None for no switches."""
    seconds = np.asarray(seconds, dtype=np.float64)
    return float((seconds <= limit_s + 1e-9).mean()) if len(seconds) else None  # a comparison with nan is false


def quantile_of_switches(seconds: Array, fraction: float) -> float | None:
    """The time in s by which ``fraction`` of the switches (M,) had come about; None where fewer ever did.

    A switch that never came about (nan) counts as one that takes longer than all others.
    """
    ordered = np.sort(np.nan_to_num(np.asarray(seconds, dtype=np.float64), nan=np.inf))
    if len(ordered) == 0:
        return None
    reached = float(ordered[int(np.ceil(fraction * len(ordered))) - 1])
    return reached if np.isfinite(reached) else None


def peak_in_windows(value: Array, starts: NDArray[np.integer], length: int) -> Array:
    """Largest value in each window: (R, T) and (M, 2) rows of (robot, first step) -> (M,); `length` in steps."""
    steps = starts[:, 1, None] + np.arange(length)
    return np.asarray(value)[starts[:, :1], steps].max(axis=1)
