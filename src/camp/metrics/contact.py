"""Foot contacts as a stance is understood: without the breaks that sensors and solvers make in it.

A foot that lands on MuJoCo's soft ground sinks in by some millimetres and is pressed out again; where it reaches the
surface before the leg's load has settled, it loses contact for one physics step (5 ms, 0.3 mm high) and lands anew.
Sampled at 50 Hz, one of four such breaks is seen, and a pronk's stance falls into two to four pieces, the expert's like
the policy's. The force threshold has no part in it: 1, 10 and 30 N see the same breaks. Real force sensors bounce
likewise. T rows, 4 legs FL, FR, RL, RR.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Floats = NDArray[np.floating]

# s: a loss of contact that is no longer is part of the stance. A row and a half of 20 ms more than the physics step
# that causes it; the shortest swing, a pace or trot of 4 Hz, takes 110 ms.
BOUNCE_S = 0.05


def debounced(contact: Bools, period_s: float, bounce_s: float = BOUNCE_S) -> Bools:
    """Close the losses of contact that last at most ``bounce_s`` s: (..., T, 4) -> (..., T, 4).

    A loss at either end of the sequence stays: nobody saw how long it was.
    """
    longest = int(np.floor(bounce_s / period_s + 1e-9))
    contact = np.asarray(contact, dtype=bool)
    if longest < 1:
        return contact
    rows = np.arange(contact.shape[-2])[:, None]
    last = np.maximum.accumulate(np.where(contact, rows, -1), axis=-2)  # row of the latest contact
    after = np.where(contact, rows, len(rows) + contact.shape[-2])
    following = np.minimum.accumulate(after[..., ::-1, :], axis=-2)[..., ::-1, :]
    inside = (last >= 0) & (following < len(rows))
    return contact | (inside & (following - last - 1 <= longest))


def hysteresis(force: Floats, on: float, off: float) -> Bools:
    """Contact from forces (T, 4) in N: begins at ``on`` or more, ends below ``off``; `on` >= `off`."""
    force = np.asarray(force, dtype=np.float64)
    decided = np.where(force >= on, 1, np.where(force < off, 0, -1))
    rows = np.arange(len(force))[:, None]
    last = np.maximum.accumulate(np.where(decided >= 0, rows, 0), axis=0)
    return np.take_along_axis(decided, last, axis=0) == 1


def touchdowns(contact: Bools) -> NDArray[np.integer]:
    """How often each foot touches down: (..., T, 4) -> (..., 4). A stance at the first row is none."""
    return (contact[..., 1:, :] & ~contact[..., :-1, :]).sum(axis=-2)


def touches_per_stride(contact: Bools, frequency_hz: Floats, period_s: float) -> Floats:
    """Touchdowns of each foot per stride: (N, T, 4) and (N,) Hz -> (N, 4); nan without a frequency.

    Counted between the first and the last touchdown, so that a fractional stride at the ends does not matter: 1 where
    every stance is one touch. A foot with fewer than two touchdowns has its plain count over the strides.
    """
    steps = contact.shape[-2]
    begins = np.zeros(contact.shape, dtype=bool)
    begins[..., 1:, :] = contact[..., 1:, :] & ~contact[..., :-1, :]
    count = begins.sum(axis=-2)
    first = begins.argmax(axis=-2)
    last = steps - 1 - begins[..., ::-1, :].argmax(axis=-2)
    cycles = np.asarray(frequency_hz)[..., None] * period_s
    whole = np.round((last - first) * cycles)
    return np.where(count >= 2, (count - 1) / np.maximum(whole, 1.0), count / (steps * cycles))


def stride_fraction(contact: Bools, frequency_hz: Floats, period_s: float, tolerance: float) -> Floats:
    """Fraction of the times between two touchdowns of a foot that last a stride, (N, T, 4) and (N,) Hz -> (N,).

    Each within ``tolerance``, a fraction of the stride, of 1 / frequency; that of the worst leg. 0 for a foot that
    touches down less than twice, and without a frequency.
    """
    begins = contact[:, 1:] & ~contact[:, :-1]
    fraction = np.zeros((len(contact), contact.shape[2]))
    for walk, hz in enumerate(frequency_hz):
        for leg in range(fraction.shape[1]) if np.isfinite(hz) else ():
            between = np.diff(np.flatnonzero(begins[walk, :, leg])) * period_s * hz
            fraction[walk, leg] = (np.abs(between - 1.0) <= tolerance).mean() if len(between) else 0.0
    return fraction.min(axis=1)
