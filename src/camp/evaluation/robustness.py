"""Part "robustness": the same random walks under one disturbance at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camp.evaluation.reading import Reading
from camp.evaluation.report import ConditionSummary
from camp.evaluation.values import fraction


def summarize_robustness(reading: Reading, names: Sequence[str]) -> dict[str, ConditionSummary]:
    """Gait accuracy, falls and velocity errors per condition; the robots come condition by condition."""
    each = len(reading.wanted) // len(names)
    result = {}
    for number, name in enumerate(names):
        part = reading.take(np.arange(number * each, (number + 1) * each))
        skills = {skill: float(part.right[chosen].mean()) for skill, chosen in part.groups() if skill != "all"}
        result[name] = ConditionSummary(
            rollouts=each,
            falls=int(part.fallen.sum()),
            gait_accuracy=fraction(part.right),
            linear_error_m_s=float(part.error.linear.mean()),
            yaw_rate_error_rad_s=float(part.error.angular.mean()),
            skills=skills,
        )
    return result
