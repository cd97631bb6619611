"""Part "tracking": the base's velocity against its command, slow and fast commands apart."""

from __future__ import annotations

import numpy as np

from camp.evaluation.reading import Reading
from camp.evaluation.report import BinError, TrackingSummary
from camp.evaluation.values import mean_estimate
from camp.metrics.tracking import (
    FAST_COMMAND_M_S,
    VelocityError,
    velocity_error_by_command,
    velocity_error_by_turn,
)

FAST_TURN_RAD_S = 0.3


def summarize_tracking(reading: Reading) -> dict[str, TrackingSummary]:
    """Errors of the mean velocity in bins of the commanded speed and of the commanded yaw rate, per skill and all."""
    return {name: _errors(reading, chosen) for name, chosen in reading.groups()}


def _errors(reading: Reading, chosen: np.ndarray) -> TrackingSummary:
    command = reading.command[chosen]
    error = VelocityError(reading.error.linear[chosen], reading.error.angular[chosen])
    return TrackingSummary(
        by_speed=_plain(velocity_error_by_command(command, error, (FAST_COMMAND_M_S,))),
        by_turn=_plain(velocity_error_by_turn(command, error, (FAST_TURN_RAD_S,))),
        linear_error_m_s=mean_estimate(error.linear),
        yaw_rate_error_rad_s=mean_estimate(error.angular),
    )


def _plain(bins: dict[str, VelocityError]) -> dict[str, BinError]:
    return {name: BinError(float(one.linear), float(one.angular)) for name, one in bins.items()}
