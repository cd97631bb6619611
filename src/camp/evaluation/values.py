"""From arrays to plain values that strict JSON holds: None where there is nothing to average."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camp.metrics.tracking import by_joint_kind

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


def by_kind(accuracy: Floats) -> dict[str, float]:
    """Mean over roll-outs and legs of (R, 12), per kind of joint; empty where there are no roll-outs."""
    return {k: float(v) for k, v in by_joint_kind(accuracy.mean(axis=0)).items()} if len(accuracy) else {}
