"""How near a motion is to a demonstration: dynamic time warping. numpy, and tslearn for the warping."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


def stride_window(state: Array, contact: NDArray[np.bool_], length: int) -> Array:
    """``length`` rows of a motion (T, S) from the first touchdown of its first foot on; fewer where it ends before.

    contact: (T, 4) bool. Warping pins the first rows of two motions to each other, so both have to begin at the same
    point of the stride. Where no foot touches down early enough for a whole window, the last ``length`` rows.
    """
    begins = np.flatnonzero(contact[1:, 0] & ~contact[:-1, 0]) + 1
    latest = max(len(state) - length, 0)
    first = int(begins[0]) if len(begins) and begins[0] <= latest else latest
    return state[first : first + length]


def dtw_distance(first: Array, second: Array, scale: Array) -> float:
    """Distance of two motions (T1, S) and (T2, S) along the best warping path, in units of ``scale`` (S,).

    sqrt(sum over the path of |(x - y) / scale|^2 / (max(T1, T2) S)): about the root mean square distance of one entry
    in one frame. 0 for the same motion, and for one that only runs unevenly; about sqrt(2) for unrelated noise of
    standard deviation ``scale`` that is not warped.
    """
    from tslearn.metrics import dtw  # compiles itself, which nobody else should wait for

    longest = max(len(first), len(second))
    return float(dtw(first / scale, second / scale) / np.sqrt(longest * first.shape[1]))


def nearest_distance(motion: Array, demonstrations: list[Array], scale: Array) -> float:
    """`dtw_distance` to the nearest of some demonstrations, each (T, S); nan where there are none."""
    return min((dtw_distance(motion, one, scale) for one in demonstrations), default=float("nan"))
