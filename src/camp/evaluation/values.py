"""From arrays to plain values that strict JSON holds: None where there is nothing to average."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camp.evaluation.report import Estimate
from camp.metrics.statistics import Interval, fraction_interval, mean_interval

Floats = NDArray[np.floating]


def mean(values: Floats) -> float | None:
    """Mean of the finite values; None where there are none."""
    finite = np.asarray(values)[np.isfinite(values)]
    return float(finite.mean()) if finite.size else None


def circular_mean(phase: Floats) -> float | None:
    """Mean of phases in strides, in [0, 1); None where no finite one is given."""
    finite = phase[np.isfinite(phase)]
    if not finite.size:
        return None
    angle = np.angle(np.exp(2j * np.pi * finite).sum())
    return float(angle / (2 * np.pi) % 1.0)


def estimate(interval: Interval | None) -> Estimate | None:
    """As the report holds it."""
    return None if interval is None else Estimate(interval.value, interval.low, interval.high, interval.n)


def fraction(holds: NDArray[np.bool_]) -> Estimate | None:
    """Fraction of the walks (R,) for which something holds, with Wilson's interval."""
    return estimate(fraction_interval(int(holds.sum()), len(holds)))


def mean_estimate(values: Floats) -> Estimate | None:
    """Mean of (R,) with its bootstrap interval."""
    return estimate(mean_interval(values))
