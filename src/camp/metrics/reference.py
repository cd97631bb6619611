"""How near the joints are to the expert's, stride by stride.

The paper reports 91.23 % (thigh) and 91.38 % (calf) of "joint tracking" without a formula; this one is ours. A robot is
compared with the mean stride of the expert's clip of the same skill and command, at the robot's own measured stride
frequency and at the one phase shift that fits best, the same for all joints. J joints, B phases of the stride.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]

PHASES = 50  # of a mean stride; a row every 10 ms at 2 Hz


@dataclass(frozen=True)
class ReferenceTracking:
    """Each (J,), no unit. accuracy: 1 - mean |q - q*| / range(q*); skill: 1 - mean |q - q*| / mean |q* - median q*|,
    which no constant pose can bring above 0."""

    accuracy: Floats
    skill: Floats


def mean_stride(joint_position: Floats, frequency_hz: float, period_s: float) -> Floats:
    """Mean over the whole strides of (T, J) rad, resampled to PHASES phases: (B, J). Raises ValueError for none."""
    strides = int(len(joint_position) * period_s * frequency_hz - 1e-6)
    if strides < 1:
        raise ValueError(f"{len(joint_position) * period_s:.2f} s hold no stride of {frequency_hz:g} Hz")
    times = np.arange(strides * PHASES) / (PHASES * frequency_hz)
    rows = np.arange(len(joint_position)) * period_s
    sampled = np.stack([np.interp(times, rows, column) for column in np.asarray(joint_position).T], axis=1)
    return sampled.reshape(strides, PHASES, -1).mean(axis=0)


def reference_tracking(
    joint_position: Floats, stride: Floats, frequency_hz: float, period_s: float
) -> ReferenceTracking:
    """Compare the whole strides of (T, J) rad with a mean stride (B, J) walked at ``frequency_hz``.

    Raises ValueError where not one stride fits.
    """
    strides = int(len(joint_position) * period_s * frequency_hz + 1e-6)
    if strides < 1:
        raise ValueError(f"{len(joint_position) * period_s:.2f} s hold no stride of {frequency_hz:g} Hz")
    position = np.asarray(joint_position, dtype=np.float64)[: round(strides / (frequency_hz * period_s))]
    phase = np.mod(np.arange(len(position)) * period_s * frequency_hz, 1.0) * PHASES
    shifted = np.stack([_at(stride, phase + shift) for shift in range(PHASES)])  # (B, T, J)
    error = np.abs(shifted - position).mean(axis=1)  # (B, J)
    best = error.mean(axis=1).argmin()
    least, expert = error[best], shifted[best]
    spread = np.abs(expert - np.median(expert, axis=0)).mean(axis=0)
    return ReferenceTracking(accuracy=1.0 - least / np.ptp(stride, axis=0), skill=1.0 - least / spread)


def _at(stride: Floats, phase: Floats) -> Floats:
    """The stride (B, J) at phases (T,) in rows, linear in between: (T, J)."""
    low = np.floor(phase).astype(int)
    fraction = (phase - low)[:, None]
    return stride[low % PHASES] * (1.0 - fraction) + stride[(low + 1) % PHASES] * fraction
