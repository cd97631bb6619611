"""Part "quality": what the motion costs the robot. Averages over the walks of the grid that stayed upright."""

from __future__ import annotations

import numpy as np

from camp.evaluation.reading import Reading
from camp.evaluation.report import QualitySummary
from camp.evaluation.values import mean
from camp.metrics.effort import (
    action_rate,
    cost_of_transport,
    foot_slip,
    fraction_at_limit,
    fraction_near_stop,
    torque_use,
)
from camp.robots.quadruped import NUM_JOINTS
from camp.robots.robot import Robot

STOP_MARGIN_RAD = 0.05
MOVING_COMMAND_M_S = 0.1  # from here on a command asks for transport


def summarize_quality(robot: Robot, reading: Reading) -> dict[str, QualitySummary]:
    """Falls, limits, jerkiness, slip and energy, per skill and over all; units stand in the names."""
    mass = float(robot.load_model().body_mass.sum())
    return {name: _averages(robot, reading, chosen, mass) for name, chosen in reading.groups()}


def _averages(robot: Robot, reading: Reading, chosen: np.ndarray, mass: float) -> QualitySummary:
    upright, first = chosen & ~reading.fallen, reading.first_step
    recording = reading.recording.take(upright)
    speed = np.hypot(reading.command[:, 0], reading.command[:, 1])
    moving = upright & (speed >= MOVING_COMMAND_M_S)
    minutes = reading.recording.steps_upright[chosen].sum() * recording.period_s / 60.0
    torque, position = recording.torque[:, first:], recording.joint_position[:, first:]
    peak = torque_use(torque, np.array(robot.torque_limit)).max(axis=(1, 2), initial=0.0)
    every = torque.reshape(len(recording), 2 * torque.shape[1], NUM_JOINTS)
    lower, upper = np.array(robot.joint_lower), np.array(robot.joint_upper)
    speeds = np.abs(recording.joint_velocity[:, first:] / np.array(robot.joint_speed_limit))
    power = reading.recording.power[:, first:]
    return QualitySummary(
        falls_per_minute=float(reading.fallen[chosen].sum() / minutes) if minutes > 0 else None,
        peak_torque_share=mean(peak),
        torque_at_limit_share=mean(fraction_at_limit(every, np.array(robot.torque_limit))),
        joint_near_stop_share=mean(fraction_near_stop(position, lower, upper, STOP_MARGIN_RAD)),
        joint_speed_peak_share=mean(speeds.max(axis=(1, 2), initial=0.0)),
        action_rate_rad=mean(action_rate(recording.joint_target[:, first:])),
        foot_slip_m_s=mean(foot_slip(recording.foot_speed[:, first:], recording.step_contact[:, first:])),
        power_w=mean(power[upright].mean(axis=1)),
        cost_of_transport=cost_of_transport(power[moving], reading.velocity[moving][:, :2], mass),
    )
