"""Part "robustness": the grid once more under each condition."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from camp.evaluation.reading import read_grid
from camp.evaluation.rollout import Recording
from camp.gaits.skills import Skill


def summarize_robustness(
    recording: Recording, names: Sequence[str], skills: Sequence[Skill], discard_s: float
) -> dict[str, Any]:
    """Gait accuracy, falls and velocity errors per condition; the robots come condition by condition."""
    each = len(recording) // len(names)
    result = {}
    for number, name in enumerate(names):
        reading = read_grid(recording.take(slice(number * each, (number + 1) * each)), skills, discard_s)
        result[name] = {
            "rollouts": each,
            "falls": int(reading.fallen.sum()),
            "gait_accuracy": float(reading.right.mean()),
            "linear_error_m_s": float(reading.error.linear.mean()),
            "yaw_rate_error_rad_s": float(reading.error.angular.mean()),
            "skills": {skill: float(reading.right[chosen].mean()) for skill, chosen in reading.groups()},
        }
        del result[name]["skills"]["all"]
    return result
