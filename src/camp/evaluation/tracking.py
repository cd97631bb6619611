"""Part "tracking": the base's velocity against its command, slow and fast commands apart."""

from __future__ import annotations

from typing import Any

import numpy as np

from camp.evaluation.reading import GridReading
from camp.metrics.tracking import (
    FAST_COMMAND_M_S,
    VelocityError,
    velocity_error_by_command,
    velocity_error_by_turn,
)

FAST_TURN_RAD_S = 0.3


def summarize_tracking(reading: GridReading) -> dict[str, Any]:
    """Errors of the mean velocity in bins of the commanded speed and of the commanded yaw rate, per skill and all."""
    return {name: _bins(reading, chosen) for name, chosen in reading.groups()}


def _bins(reading: GridReading, chosen: np.ndarray) -> dict[str, Any]:
    command = reading.command[chosen]
    error = VelocityError(reading.error.linear[chosen], reading.error.angular[chosen])
    binned = {
        "by_speed": velocity_error_by_command(command, error, (FAST_COMMAND_M_S,)),
        "by_turn": velocity_error_by_turn(command, error, (FAST_TURN_RAD_S,)),
    }
    return {
        key: {
            name: {"linear_error_m_s": float(one.linear), "yaw_rate_error_rad_s": float(one.angular)}
            for name, one in bins.items()
        }
        for key, bins in binned.items()
    }
