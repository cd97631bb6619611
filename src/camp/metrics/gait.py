"""Foot contacts -> stride frequency, leg phases, duty, flight and the gait's name, without any learned judge.

Every foot's contact signal is a rectangular wave. Its fundamental carries the rhythm and the timing of the
leg; its mean over WHOLE strides carries the duty (a fractional stride would bias both: by .05 of a stride at
four strides). Legs are ordered FL, FR, RL, RR. Arrays: N sequences, T control steps, 4 legs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from camp.gaits.schedule import GAIT_PHASES

Array = NDArray[np.floating]

NO_GAIT = "none"
FREQUENCY_RANGE_HZ = (0.8, 6.0)  # slower is shuffling, faster is chatter of a foot that rests on the floor
FREQUENCY_STEP_HZ = 0.04  # of the coarse search; the parabola and the phase advance below resolve far finer
SEGMENT_S = 2.0  # rhythm is judged within a segment, so that a drifting stride rate does not count as none
DUTY_RANGE = (0.15, 0.95)  # outside it a foot is carried or rests
# Over 2 s, random contacts exceed .45 in one foot of a hundred; stepping feet with 2 % flicker exceed .75.
RHYTHM_MIN = 0.5
# Mean over the six leg pairs. A hind pair late by .15 stride gives .1; a walk (hind pair at a quarter stride)
# gives .167.
PHASE_TOLERANCE = 0.1

_LEG_PAIRS = np.array(list(combinations(range(4), 2)))  # (6, 2)


@dataclass(frozen=True)
class GaitMeasurement:
    """What the feet of N robots did.

    frequency_hz    (N,)   stride frequency, Hz; nan where no foot steps
    phase           (N, 4) in [0, 1): fraction of a stride by which the middle of each leg's stance comes after
                           FL's, the touchdown offset of `camp.gaits.schedule` where duties are equal; nan where
                           that foot or FL does not step
    duty            (N, 4) fraction of the stride in stance
    flight_fraction (N,)   fraction of the time with no foot on the floor
    rhythm          (N, 4) amplitude of the fundamental over that of a perfectly periodic foot of the same
                           duty: 1 regular, 0 still
    stepping        (N, 4) bool: rhythm and duty both are those of a stepping foot
    label           (N,)   str: trot, pace, bound, pronk or none
    """

    frequency_hz: Array
    phase: Array
    duty: Array
    flight_fraction: Array
    rhythm: Array
    stepping: NDArray[np.bool_]
    label: NDArray[np.str_]


def measure_gait(contact: NDArray[np.bool_], period_s: float) -> GaitMeasurement:
    """Measure the gait of N contact sequences.

    contact: (N, T, 4) bool, True where the foot carries load; period_s: time between rows, s (0.02).
    T should span two strides or more; a sequence shorter than one stride is labelled none.
    Raises ValueError where contact has another shape.
    """
    if contact.ndim != 3 or contact.shape[2] != 4 or contact.shape[1] < 4:
        raise ValueError(f"contact has shape {contact.shape}: pass (N, T, 4), T >= 4, legs FL, FR, RL, RR")
    signal = _segments(np.asarray(contact, dtype=np.float64), period_s)  # (N, M, L, 4)
    frequency = _refine(signal, _coarse_frequency(signal, period_s), period_s)

    weight = _whole_strides(signal.shape[2], frequency * period_s)  # (N, L)
    duty = np.einsum("nl,nmlk->nk", weight, signal) / signal.shape[1]
    flight = np.einsum("nl,nml->n", weight, 1.0 - signal.max(axis=-1)) / signal.shape[1]
    phasor = _phasor(signal, weight, frequency * period_s)  # (N, M, 4)

    rhythm = _rhythm(np.abs(phasor).mean(axis=1), duty)
    whole_stride = signal.shape[2] * period_s * frequency >= 1.0
    steps_at_all = (duty > DUTY_RANGE[0]) & (duty < DUTY_RANGE[1])
    stepping = (rhythm >= RHYTHM_MIN) & steps_at_all & whole_stride[:, None]
    delay = (phasor[:, :, :1] * phasor.conj()).sum(axis=1)
    phase = np.mod(np.angle(delay) / (2 * np.pi), 1.0)
    phase[phase == 1.0] = 0.0  # np.mod rounds tiny negative angles up to 1
    return GaitMeasurement(
        frequency_hz=np.where(stepping.any(axis=1), frequency, np.nan),
        phase=np.where(stepping & stepping[:, :1], phase, np.nan),
        duty=duty,
        flight_fraction=flight,
        rhythm=rhythm,
        stepping=stepping,
        label=_label(phase, stepping.all(axis=1)),
    )


def pair_phase_errors(phase: Array, gait: str) -> Array:
    """How far each pair of legs is from the gait's timing, in strides.

    phase: (..., 4) in strides; gait: a key of GAIT_PHASES. Returns (..., 6), each in [0, .5], for the pairs
    FL-FR, FL-RL, FL-RR, FR-RL, FR-RR, RL-RR. Differences between legs do not depend on when the stride is
    said to begin.
    """
    deviation = np.asarray(phase) - np.asarray(GAIT_PHASES[gait])
    between = deviation[..., _LEG_PAIRS[:, 0]] - deviation[..., _LEG_PAIRS[:, 1]]
    return np.abs(between - np.round(between))


def phase_error(phase: Array, gait: str) -> Array:
    """Mean of `pair_phase_errors`, (..., 4) -> (...,), in strides: the distance the label is decided by."""
    return pair_phase_errors(phase, gait).mean(axis=-1)


def measure_over_time(contact: NDArray[np.bool_], period_s: float, window_s: float = 1.0) -> GaitMeasurement:
    """The gait at each of the T control steps of one sequence (T, 4), read from the window centred on it.

    The first and last half window repeat the nearest whole window. Centred, so that a label changes where the gait
    does, not half a window later. Raises ValueError where the sequence is shorter than the window.
    """
    length = round(window_s / period_s)
    if len(contact) < length:
        raise ValueError(
            f"contact holds {len(contact)} steps, the window {length}: pass more steps or a shorter window"
        )
    windows = np.moveaxis(sliding_window_view(contact, length, axis=0), -1, 1)  # (T - L + 1, L, 4)
    measured = measure_gait(windows, period_s)
    centre = np.clip(np.arange(len(contact)) - length // 2, 0, len(windows) - 1)
    return GaitMeasurement(**{name: value[centre] for name, value in vars(measured).items()})


def label_over_time(contact: NDArray[np.bool_], period_s: float, window_s: float = 1.0) -> list[str]:
    """The label of `measure_over_time` at each step."""
    return measure_over_time(contact, period_s, window_s).label.tolist()


def switch_time(label: Sequence[str], gait: str, switch_step: int, period_s: float, hold_s: float = 1.0) -> float:
    """Seconds from the switch until the new gait is labelled for hold_s without a break; nan if never.

    label: one name, of a gait or a skill, per control step; switch_step: the row at which `gait` was commanded.
    """
    right = np.asarray(label[switch_step:]) == gait
    length = round(hold_s / period_s)
    if len(right) < length:
        return float("nan")
    completed = np.flatnonzero(sliding_window_view(right, length).all(axis=1))
    return float(completed[0] * period_s) if len(completed) else float("nan")


def _segments(signal: Array, period_s: float) -> Array:
    """(N, T, 4) -> (N, M, L, 4): M equal parts of about SEGMENT_S; at most M - 1 last rows are left out."""
    steps = signal.shape[1]
    count = max(1, round(steps * period_s / SEGMENT_S))
    length = steps // count
    return signal[:, : count * length].reshape(len(signal), count, length, 4)


def _coarse_frequency(signal: Array, period_s: float) -> Array:
    """Peak of the Hann-windowed power, summed over feet and segments, Hz (N,).

    Power is summed foot by foot: adding the signals first would cancel the fundamental of trot, pace and
    bound and leave the second harmonic. Within one foot the fundamental, sin(pi duty), always exceeds the
    k-th harmonic, sin(k pi duty) / k.
    """
    length = signal.shape[2]
    window = np.hanning(length + 2)[1:-1]
    centred = (signal - np.einsum("l,nmlk->nmk", window / window.sum(), signal)[:, :, None]) * window[:, None]
    grid = np.arange(FREQUENCY_RANGE_HZ[0], FREQUENCY_RANGE_HZ[1] + FREQUENCY_STEP_HZ / 2, FREQUENCY_STEP_HZ)
    angle = 2 * np.pi * period_s * np.outer(np.arange(length), grid)  # (L, F)
    rows = np.swapaxes(centred, 2, 3).reshape(-1, length)
    power = (rows @ np.cos(angle)) ** 2 + (rows @ np.sin(angle)) ** 2
    power = power.reshape(len(signal), signal.shape[1] * signal.shape[3], len(grid)).sum(axis=1)  # (N, F)

    peak = np.clip(power.argmax(axis=1), 1, len(grid) - 2)
    left, middle, right = (np.take_along_axis(power, (peak + i)[:, None], axis=1)[:, 0] for i in (-1, 0, 1))
    curvature = left - 2 * middle + right
    offset = np.where(curvature < 0, (left - right) / np.where(curvature < 0, 2 * curvature, 1.0), 0.0)
    return grid[peak] + np.clip(offset, -1.0, 1.0) * FREQUENCY_STEP_HZ


def _refine(signal: Array, frequency: Array, period_s: float) -> Array:
    """Correct the frequency by the feet's phase advance from the first to the last whole strides, Hz (N,).

    Over whole strides the mean and the harmonics are orthogonal to the fundamental, so short sequences lose
    their leakage bias.
    """
    length = signal.shape[2]
    for _ in range(3):
        cycles = frequency * period_s  # strides per step
        strides = np.maximum(1, np.floor(length * cycles / 2))
        first = _window(length, strides / cycles)
        last = first[:, ::-1]
        drift = (_phasor(signal, last, cycles) * _phasor(signal, first, cycles).conj()).sum(axis=(1, 2))
        gap_s = np.maximum(length - strides / cycles, 1.0) * period_s
        correction = np.angle(drift) / (2 * np.pi * gap_s)
        frequency = np.clip(frequency + correction, *FREQUENCY_RANGE_HZ)
    return frequency


def _window(length: int, width: Array) -> Array:
    """Weights (N, L) summing to 1 over the first `width` (N,) rows, the last row by its fraction."""
    weight = np.clip(width[:, None] - np.arange(length), 0.0, 1.0)
    return weight / weight.sum(axis=1, keepdims=True)


def _whole_strides(length: int, cycles: Array) -> Array:
    """Weights (N, L) over the largest whole number of strides that fits; cycles: strides per step (N,)."""
    return _window(length, np.maximum(1, np.floor(length * cycles)) / cycles)


def _phasor(signal: Array, weight: Array, cycles: Array) -> NDArray[np.complex128]:
    """Fourier coefficient of each foot at `cycles` strides per step: (N, M, L, 4) -> (N, M, 4) complex."""
    turn = weight * np.exp(-2j * np.pi * cycles[:, None] * np.arange(signal.shape[2]))  # (N, L)
    return np.matmul(turn[:, None, None, :], signal)[:, :, 0]


def _rhythm(amplitude: Array, duty: Array) -> Array:
    """Amplitude over sin(pi duty) / pi, the fundamental of a rectangular wave of that duty, at most 1."""
    regular = np.sin(np.pi * np.clip(duty, 0.0, 1.0)) / np.pi
    return np.minimum(np.divide(amplitude, regular, out=np.zeros_like(amplitude), where=regular > 1e-3), 1.0)


def _label(phase: Array, stepping: NDArray[np.bool_]) -> NDArray[np.str_]:
    names = np.array([*GAIT_PHASES, NO_GAIT])
    error = np.stack([phase_error(phase, gait) for gait in GAIT_PHASES])  # (gaits, N)
    known = stepping & (error.min(axis=0) <= PHASE_TOLERANCE)
    return names[np.where(known, error.argmin(axis=0), len(GAIT_PHASES))]
