"""Judging clips: does a motion do what it says, within the robot's limits, and can it be repeated?"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from camp.metrics.gait import measure_gait, pair_phase_errors
from camp.metrics.tracking import mean_velocity, velocity_error
from camp.motion.clips import Clip
from camp.motion.gaits import GaitSchedule
from camp.robots.go2 import JOINT_LOWER, JOINT_SPEED_LIMIT, JOINT_UPPER, TORQUE_LIMIT, load_model

REPLAY_DURATION = 0.5  # s

LOWEST_BASE = 0.15  # m
LARGEST_TILT = 0.8  # rad, the environment's own limit
FREQUENCY_ERROR = 0.03  # of the stride frequency
PHASE_ERROR = 0.05  # strides, worst pair of legs
CONTACT_MATCH = 0.9  # share of rows and feet that follow the schedule
SPEED_ERROR = 0.05  # m/s
TURN_ERROR = 0.05  # rad/s
# Velocities against differences of positions, root mean square over the clip as a share of the velocities'
# own (plus a floor): 20 ms apart, impacts fall between two rows.
CONSISTENCY = 0.25
REPLAY_ERROR = 0.1  # rad, root mean square over joints and rows


_ROUNDING = 1e-5  # of float32


@dataclass(frozen=True)
class ClipCheck:
    """One criterion: the measured value must be `bound` ("<=" or ">=") the limit. NaN never passes."""

    name: str
    value: float
    limit: float
    bound: str = "<="

    @property
    def passed(self) -> bool:
        """Whether the criterion holds."""
        return self.value <= self.limit if self.bound == "<=" else self.value >= self.limit


def check_clip(clip: Clip, replay: bool = True) -> list[ClipCheck]:
    """Every criterion that applies to the clip; what needs a constant command applies to steady clips only.

    replay: also repeat the first half second in the learner's simulation (some milliseconds).
    """
    checks = [*_posture(clip), *_consistency(clip)]
    if clip.is_steady:
        checks += _joints(clip) + _gait(clip) + _speed(clip)
    if replay:
        checks.append(_at_most("replay (rad)", replay_error(clip), REPLAY_ERROR))
    return checks


def _at_most(name: str, value: float, limit: float) -> ClipCheck:
    return ClipCheck(name, float(value), limit, "<=")


def _at_least(name: str, value: float, limit: float) -> ClipCheck:
    return ClipCheck(name, float(value), limit, ">=")


def rotation_matrix(quaternion: np.ndarray) -> np.ndarray:
    """Quaternions (..., 4), w first, to matrices (..., 3, 3)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, dtype=np.float64), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def _posture(clip: Clip) -> list[ClipCheck]:
    tilt = np.arccos(np.clip(rotation_matrix(clip.base_quaternion)[:, 2, 2], -1.0, 1.0))
    torque = np.abs(clip.joint_torque / np.array(TORQUE_LIMIT)).max()
    return [
        _at_least("lowest base (m)", clip.base_position[:, 2].min(), LOWEST_BASE),
        _at_most("largest tilt (rad)", tilt.max(), LARGEST_TILT),
        _at_most("torque / limit", torque, 1.0 + _ROUNDING),
    ]


def _joints(clip: Clip) -> list[ClipCheck]:
    """Range and speed: a stumble may pass them for a moment, steady walking may not."""
    beyond = np.maximum(clip.joint_position - np.array(JOINT_UPPER), np.array(JOINT_LOWER) - clip.joint_position)
    return [
        _at_most("joint beyond range (rad)", beyond.max(), 0.0),
        _at_most("joint speed / limit", np.abs(clip.joint_velocity / np.array(JOINT_SPEED_LIMIT)).max(), 1.0),
    ]


def _gait(clip: Clip) -> list[ClipCheck]:
    measured = measure_gait(clip.foot_contact[None], clip.dt)
    frequency_error = abs(measured.frequency_hz[0] / clip.frequency_hz - 1.0)
    phase_error = pair_phase_errors(measured.phase[0], clip.gait).max()
    return [
        _at_most("frequency error", frequency_error, FREQUENCY_ERROR),
        _at_most("phase error (strides)", phase_error, PHASE_ERROR),
        _at_least("contact match", contact_match(clip), CONTACT_MATCH),
    ]


def contact_match(clip: Clip) -> float:
    """Share of rows and feet that follow the gait's schedule, at the best start of the stride."""
    schedule = GaitSchedule(clip.gait, clip.frequency_hz)
    starts = np.arange(0.0, schedule.period, 0.002)
    times = starts[:, None] + np.arange(len(clip)) * clip.dt
    return float((schedule.contact(times) == clip.foot_contact).mean(axis=(1, 2)).max())


def heading_velocity(clip: Clip) -> np.ndarray:
    """Velocity (T, 3) in the level frame that turns with the base: vx, vy in m/s and yaw rate in rad/s."""
    rotation = rotation_matrix(clip.base_quaternion)
    world = np.einsum("tij,tj->ti", rotation, clip.base_linear_velocity)
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    cosine, sine = np.cos(yaw), np.sin(yaw)
    forward = cosine * world[:, 0] + sine * world[:, 1]
    left = -sine * world[:, 0] + cosine * world[:, 1]
    turn = np.einsum("tij,tj->ti", rotation, clip.base_angular_velocity)[:, 2]
    return np.stack([forward, left, turn], axis=1)


def _speed(clip: Clip) -> list[ClipCheck]:
    mean = mean_velocity(heading_velocity(clip), clip.dt, clip.frequency_hz)
    error = velocity_error(clip.command, mean)
    return [
        _at_most("speed error (m/s)", float(error.linear), SPEED_ERROR),
        _at_most("turn error (rad/s)", float(error.angular), TURN_ERROR),
    ]


def _consistency(clip: Clip) -> list[ClipCheck]:
    rotation = rotation_matrix(clip.base_quaternion)
    world = np.einsum("tij,tj->ti", rotation, clip.base_linear_velocity)
    relative = np.swapaxes(rotation[:-1], 1, 2) @ rotation[1:]
    turned = (
        np.stack(
            [
                relative[:, 2, 1] - relative[:, 1, 2],
                relative[:, 0, 2] - relative[:, 2, 0],
                relative[:, 1, 0] - relative[:, 0, 1],
            ],
            axis=1,
        )
        / 2
    )  # rotation vector of small angles
    moved = {
        "base velocity": (np.diff(clip.base_position, axis=0), world, 0.1),
        "base turning": (turned, clip.base_angular_velocity, 0.2),
        "joint velocity": (np.diff(clip.joint_position, axis=0), clip.joint_velocity, 0.5),
        "foot velocity": (np.diff(clip.foot_position, axis=0), clip.foot_velocity, 0.1),
    }
    return [
        _at_most(f"{name} mismatch", _mismatch(change / clip.dt, velocity, floor), CONSISTENCY)
        for name, (change, velocity, floor) in moved.items()
    ]


def _mismatch(difference: np.ndarray, velocity: np.ndarray, floor: float) -> float:
    """Distance of differences (T - 1, ...) from the mean velocities, as a share of the velocities' size."""
    middle = (velocity[1:] + velocity[:-1]) / 2
    return float(np.sqrt(np.mean((difference - middle) ** 2)) / (np.sqrt(np.mean(velocity**2)) + floor))


def replay_error(clip: Clip) -> float:
    """RMS joint error in rad when the applied targets of the first half second are repeated open loop."""
    model = load_model()
    data = mujoco.MjData(model)
    rotation = rotation_matrix(clip.base_quaternion[0])
    data.qpos[:] = np.concatenate([clip.base_position[0], clip.base_quaternion[0], clip.joint_position[0]])
    data.qvel[:3] = rotation @ clip.base_linear_velocity[0]
    data.qvel[3:6], data.qvel[6:] = clip.base_angular_velocity[0], clip.joint_velocity[0]
    rows = min(round(REPLAY_DURATION / clip.dt), len(clip) - 1)
    substeps = round(clip.dt / model.opt.timestep)
    errors = np.empty((rows, 12))
    for row in range(rows):
        data.ctrl[:] = clip.joint_target_applied[row]
        for _ in range(substeps):
            mujoco.mj_step(model, data)
        errors[row] = data.qpos[7:] - clip.joint_position[row + 1]
    return float(np.sqrt(np.mean(errors**2)))
