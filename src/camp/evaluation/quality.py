"""Part "quality": what the motion costs the robot. Averages over the roll-outs of the grid that stayed upright."""

from __future__ import annotations

from typing import Any

import numpy as np

from camp.evaluation.reading import GridReading
from camp.evaluation.values import mean
from camp.metrics.effort import (
    action_rate,
    cost_of_transport,
    foot_slip,
    fraction_at_limit,
    fraction_near_stop,
    torque_use,
)
from camp.robots import go2

STOP_MARGIN_RAD = 0.05
MOVING_COMMAND_M_S = 0.1  # from here on a command asks for transport


def summarize_quality(reading: GridReading) -> dict[str, Any]:
    """Falls, limits, jerkiness, slip and energy, per skill and over all; units stand in the keys."""
    mass = float(go2.load_model().body_mass.sum())
    return {name: _averages(reading, chosen, mass) for name, chosen in reading.groups()}


def _averages(reading: GridReading, chosen: np.ndarray, mass: float) -> dict[str, Any]:
    upright = chosen & ~reading.fallen
    recording = reading.recording.take(upright)
    speed = np.hypot(reading.command[:, 0], reading.command[:, 1])
    moving = upright & (speed >= MOVING_COMMAND_M_S)
    minutes = reading.recording.steps_upright[chosen].sum() * recording.period_s / 60.0
    peak = torque_use(recording.torque, np.array(go2.TORQUE_LIMIT)).max(axis=(1, 2), initial=0.0)
    torque = recording.torque.reshape(len(recording), -1, go2.NUM_JOINTS)
    return {
        "falls_per_minute": float(reading.fallen[chosen].sum() / minutes) if minutes > 0 else None,
        "peak_torque_share": mean(peak),
        "torque_at_limit_share": mean(fraction_at_limit(torque, np.array(go2.TORQUE_LIMIT))),
        "joint_near_stop_share": mean(
            fraction_near_stop(
                recording.joint_position, np.array(go2.JOINT_LOWER), np.array(go2.JOINT_UPPER), STOP_MARGIN_RAD
            )
        ),
        "joint_speed_peak_share": mean(
            np.abs(recording.joint_velocity / np.array(go2.JOINT_SPEED_LIMIT)).max(axis=(1, 2), initial=0.0)
        ),
        "action_rate_rad": mean(action_rate(recording.joint_target)),
        "foot_slip_m_s": mean(foot_slip(recording.foot_speed, recording.contact)),
        "power_w": mean(recording.power.mean(axis=1)),
        "cost_of_transport": cost_of_transport(reading.recording.power[moving], reading.velocity[moving][:, :2], mass),
    }
