"""When is a walk right? Every criterion of the judge, on contacts and foot heights alone; docs/judge.md specifies them.

A label at the best moment is not a gait: the criteria ask for the whole walk. Arrays: N walks, T rows, 4 legs FL, FR,
RL, RR.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from camp.gaits.schedule import GAIT_PHASES, nominal_duty, nominal_flight
from camp.metrics.contact import BOUNCE_S, debounced, stride_fraction, touches_per_stride
from camp.metrics.gait import NO_GAIT, measure_gait, pair_phase_errors

Bools = NDArray[np.bool_]
Floats = NDArray[np.floating]

CRITERIA = ("gait", "frequency", "phase", "duty", "touches", "flight", "lift")  # in the order in which they are told
RHYTHM_PERIOD_S = 0.02  # labels and frequencies are read at about this rate, flight and duty at the log's own
FLYING = ("bound", "pronk")
FINEST_BOUND_PERIOD_S = 0.01  # a bound flies for 10 to 20 ms at a time, which a coarser log misses


@dataclass(frozen=True)
class Limits:
    """Thresholds of suite v1. Those of phase and duty are 2 and 1.5 times the largest deviation of the expert's steady
    clips (.04 and .10)."""

    bounce_s: float = BOUNCE_S  # losses of contact up to this long are part of the stance
    window_fraction: float = 0.9  # of the windows, and of the strides in which a foot lifts
    label_window_s: float = 1.0
    frequency_window_s: float = 2.0
    hop_s: float = 0.1  # from one window to the next
    frequency_tolerance: float = 0.15  # fraction of the skill's frequency; without one, of the walk's median
    frequency_range_hz: tuple[float, float] = (1.0, 5.0)  # faster is chatter, or several touches per stride
    pair_error: float = 0.08  # strides, worst pair of legs
    duty_error: float = 0.15  # each leg, from the gait's own
    touches: tuple[float, float] = (0.9, 1.1)  # per stride, each leg
    stride_tolerance: float = 0.25  # strides, by which the time between two touchdowns of a foot may miss one stride
    flight_of_own: float = 0.5  # pronk: fraction of the gait's own flight
    bound_flight: float = 0.02  # fraction of the time, where the log is fine enough
    bound_overlap: float = 0.1  # fraction of the time that a front and a hind foot stand
    lift_m: float = 0.02  # highest point of each swing above the ground


@dataclass(frozen=True)
class ContactLog:
    """Contacts (N, T, 4) every ``period_s`` s and, where known, heights (N, T2, 4) m of each foot's lowest point above
    the ground every ``height_period_s`` s."""

    contact: Bools
    period_s: float
    height: Floats | None = None
    height_period_s: float = 0.02

    def take(self, rows: slice | NDArray) -> ContactLog:
        """The walks ``rows``."""
        height = None if self.height is None else self.height[rows]
        return ContactLog(self.contact[rows], self.period_s, height, self.height_period_s)


@dataclass(frozen=True)
class WalkReading:
    """What the feet of N walks did, and how steadily."""

    gait: NDArray[np.str_]  # (N,) label of at least `window_fraction` of the 1-s windows, else "none"
    gait_fraction: Floats  # (N,) fraction of the windows that show the most frequent label
    frequency_hz: Floats  # (N,) median of the 2-s windows; nan where none shows a rhythm
    window_frequency: Floats  # (N, W) of each 2-s window
    phase: Floats  # (N, 4) as `measure_gait` gives it
    duty: Floats  # (N, 4)
    flight: Floats  # (N,) fraction of the time without a foot on the ground
    overlap: Floats  # (N,) fraction of the time in which a front and a hind foot stand
    touches: Floats  # (N, 4) per stride
    stride_fraction: Floats  # (N,) fraction of the times between two touchdowns that last a stride, of the worst leg
    lift: Floats | None  # (N,) fraction of the strides in which every foot lifts; None without heights
    stepping: Bools  # (N,) every foot steps
    period_s: float  # of the contacts

    def take(self, rows: NDArray) -> WalkReading:
        """The walks ``rows``."""
        arrays = {name: value[rows] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return replace(self, **arrays)


def read_walks(log: ContactLog, limits: Limits | None = None) -> WalkReading:
    """Measure N walks. Raises ValueError where they are shorter than a frequency window."""
    limits = limits or Limits()
    contact = debounced(log.contact, log.period_s, limits.bounce_s)
    every = max(1, int(RHYTHM_PERIOD_S / log.period_s + 1e-6))
    coarse, period = contact[:, ::every], log.period_s * every
    labels = _in_windows(coarse, period, limits.label_window_s, limits.hop_s)
    rhythms = _in_windows(coarse, period, limits.frequency_window_s, limits.hop_s)
    low, high = limits.frequency_range_hz
    with np.errstate(invalid="ignore"):
        label = np.where((labels.frequency_hz >= low) & (labels.frequency_hz <= high), labels.label, NO_GAIT)
    num = len(contact)
    gait, fraction = _most_frequent(label.reshape(num, -1))
    frequency = rhythms.frequency_hz.reshape(num, -1)
    median = _median(frequency)
    whole = measure_gait(coarse, period)
    fine = _whole_strides(contact, median, log.period_s)
    on_ground = np.stack([contact[..., :2].any(axis=2), contact[..., 2:].any(axis=2)], axis=2)  # front, hind
    return WalkReading(
        gait=np.where(fraction >= limits.window_fraction, gait, NO_GAIT),
        gait_fraction=fraction,
        frequency_hz=median,
        window_frequency=frequency,
        phase=whole.phase,
        duty=_mean(contact, fine),
        flight=_mean(~on_ground.any(axis=2), fine),
        overlap=_mean(on_ground.all(axis=2), fine),
        touches=touches_per_stride(contact, median, log.period_s),
        stride_fraction=stride_fraction(contact, median, log.period_s, limits.stride_tolerance),
        lift=None if log.height is None else lift_fraction(log.height, median, log.height_period_s, limits.lift_m),
        stepping=np.asarray(whole.stepping.all(axis=1)),
        period_s=log.period_s,
    )


def failures(
    reading: WalkReading, gait: str, frequency_hz: float | None = None, limits: Limits | None = None
) -> Mapping[str, Bools]:
    """Which criteria N walks fail as a skill's, each (N,) bool, by the names of CRITERIA.

    gait: a key of GAIT_PHASES; frequency_hz: None for the gait at any steady frequency. Without heights nothing can
    fail "lift". A walk is right where nothing fails.
    """
    limits = limits or Limits()
    measured = reading.frequency_hz
    wanted = measured if frequency_hz is None else np.full_like(measured, frequency_hz)
    with np.errstate(invalid="ignore"):
        near = np.abs(reading.window_frequency / wanted[:, None] - 1.0) <= limits.frequency_tolerance
        low, high = limits.frequency_range_hz
        steady = (near.mean(axis=1) >= limits.window_fraction) & (measured >= low) & (measured <= high)
    hz = np.nan_to_num(measured, nan=2.0)
    own_duty = np.array([nominal_duty(gait, value) for value in hz])
    pair = np.nan_to_num(pair_phase_errors(reading.phase, gait), nan=1.0).max(axis=1)
    touches = np.nan_to_num(reading.touches, nan=0.0)
    several = ((touches < limits.touches[0]) | (touches > limits.touches[1])).any(axis=1)
    return {
        "gait": reading.gait != gait,
        "frequency": ~steady,
        "phase": pair > limits.pair_error,
        "duty": np.abs(reading.duty - own_duty[:, None]).max(axis=1) > limits.duty_error,
        "touches": several | (reading.stride_fraction < limits.window_fraction),
        "flight": _grounded(reading, gait, hz, limits),
        "lift": np.zeros(len(hz), dtype=bool) if reading.lift is None else reading.lift < limits.window_fraction,
    }


def is_right(failed: Mapping[str, Bools]) -> Bools:
    """(N,) walks that fail nothing."""
    return ~np.any(list(failed.values()), axis=0)


def lift_fraction(height: Floats, frequency_hz: Floats, period_s: float, lift_m: float) -> Floats:
    """Fraction of the strides in which every foot is ``lift_m`` m above the ground at some time.

    height: (N, T, 4) m; frequency_hz: (N,). Strides are counted from the first row. 0 without a frequency.
    """
    result = np.zeros(len(height))
    for walk, hz in enumerate(frequency_hz):
        if np.isfinite(hz):
            bounds = np.round(np.arange(int(height.shape[1] * period_s * hz) + 1) / (hz * period_s)).astype(int)
            if len(bounds) > 1:
                highest = np.maximum.reduceat(height[walk, : bounds[-1]], bounds[:-1], axis=0)
                result[walk] = (highest.min(axis=1) >= lift_m).mean()
    return result


def _grounded(reading: WalkReading, gait: str, hz: Floats, limits: Limits) -> Bools:
    """(N,) walks that ought to fly and do not."""
    if gait not in FLYING:
        return np.zeros(len(hz), dtype=bool)
    if gait == "pronk":
        own = np.array([nominal_flight(gait, value) for value in np.round(hz, 1)])
        return reading.flight < limits.flight_of_own * own
    resolved = reading.period_s <= FINEST_BOUND_PERIOD_S + 1e-9
    return (reading.overlap > limits.bound_overlap) | (resolved & (reading.flight < limits.bound_flight))


def _in_windows(contact: Bools, period_s: float, window_s: float, hop_s: float):
    """`measure_gait` of every window, walk by walk."""
    length, hop = round(window_s / period_s), max(1, round(hop_s / period_s))
    if contact.shape[1] < length:
        raise ValueError(f"the walk holds {contact.shape[1] * period_s:.2f} s: give {window_s:g} s or more")
    windows = sliding_window_view(contact, length, axis=1)[:, ::hop]  # (N, W, 4, L)
    return measure_gait(np.moveaxis(windows, -1, 2).reshape(-1, length, 4), period_s)


def _most_frequent(label: NDArray[np.str_]) -> tuple[NDArray[np.str_], Floats]:
    """(N, W) -> the most frequent gait (N,) and its fraction."""
    names = np.array(list(GAIT_PHASES))
    fraction = np.stack([(label == name).mean(axis=1) for name in names], axis=1)
    return names[fraction.argmax(axis=1)], fraction.max(axis=1)


def _median(frequency: Floats) -> Floats:
    """Median of the finite values of each row; nan where there are none."""
    known = np.isfinite(frequency).any(axis=1)
    result = np.full(len(frequency), np.nan)
    result[known] = np.nanmedian(frequency[known], axis=1)
    return result


def _whole_strides(contact: Bools, frequency_hz: Floats, period_s: float) -> Floats:
    """Weights (N, T), 1 over the last whole number of strides, else 0; 1 everywhere where not one fits."""
    steps = contact.shape[1]
    strides = np.floor(steps * period_s * np.nan_to_num(frequency_hz) + 1e-6)
    with np.errstate(invalid="ignore", divide="ignore"):
        rows = np.where(strides >= 1, strides / (np.nan_to_num(frequency_hz) * period_s), steps)
    return (np.arange(steps) >= steps - np.round(rows)[:, None]).astype(np.float64)


def _mean(value: ArrayLike, weight: Floats) -> Floats:
    """Weighted mean over time, (N, T, ...) and (N, T) -> (N, ...)."""
    total = np.einsum("nt,nt...->n...", weight, np.asarray(value, dtype=np.float64))
    return total / weight.sum(axis=1).reshape(-1, *(1,) * (total.ndim - 1))
