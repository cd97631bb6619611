"""Validation of clips: agreement with label and command, the robot's limits, and open-loop replay."""

from __future__ import annotations

import mujoco
import numpy as np

from camp.gaits.schedule import nominal_contact, nominal_duty, nominal_flight
from camp.metrics.gait import measure_gait, pair_phase_errors
from camp.metrics.tracking import mean_velocity, velocity_error
from camp.motion.clips.clip import STAND, Clip
from camp.motion.clips.consistency import ClipCheck, at_least, at_most, foot_height, guard_checks, rotation_matrix
from camp.robots.robot import Robot

REPLAY_DURATION = 0.5  # s
REPLAY_ERROR = 0.05  # rad, root mean square over joints and rows

FREQUENCY_ERROR = 0.03  # of the stride frequency
PHASE_ERROR = 0.05  # strides, worst pair of legs
DISTURBED_PHASE_ERROR = 0.08  # where commands change or the robot is pushed
CONTACT_MATCH = 0.9  # fraction of rows and feet that follow the schedule
DISTURBED_CONTACT_MATCH = 0.85
DUTY_ERROR = 0.12  # strides, mean of the legs: 30 ms at 4 Hz, a row and a half
FLIGHT_ERROR = 0.2  # of the stride, as the feet's switches add up
SPEED_ERROR = 0.05  # m/s
TURN_ERROR = 0.05  # rad/s
STANCE_HEIGHT = 0.005  # m, root mean square height above the floor of feet that are said to stand
STANCE_SLIP = 0.5  # m/s, root mean square speed of feet that are said to stand
# rad, root mean square: what the PD received is the expert's answer, but for the noise of perturbed clips.
LABEL_ERROR = {False: 1e-6, True: 0.13}


def check_clip(robot: Robot, clip: Clip, replay: bool = True) -> list[ClipCheck]:
    """Every criterion that applies to the clip.

    Perturbed clips and transitions have no steady rhythm to judge, and noise may drive a joint to its stop; the
    mean speed is judged where one command is held; imported motion has no targets to repeat.
    replay: also repeat the first half second in the learner's simulation (some milliseconds).
    """
    checks = [
        *guard_checks(robot, clip),
        at_most("stance height (m)", stance_height(robot, clip), STANCE_HEIGHT),
        at_most("stance slip (m/s)", stance_slip(clip), STANCE_SLIP),
    ]
    if clip.has_targets:
        checks.append(at_most("label off applied (rad)", label_error(clip), LABEL_ERROR[clip.split == "perturbed"]))
    if clip.split != "perturbed":
        checks += _joints(robot, clip)
    if clip.split in ("steady", "varied", "recovery"):
        checks += _gait(clip)
    if clip.gait == STAND:
        checks.append(at_least("contact match", clip.foot_contact.mean(), CONTACT_MATCH))
    if clip.holds_command and clip.split != "perturbed":
        checks += _speed(clip)
    if replay and clip.has_targets:
        checks.append(at_most("replay (rad)", replay_error(robot, clip), REPLAY_ERROR))
    return checks


def _joints(robot: Robot, clip: Clip) -> list[ClipCheck]:
    lower, upper = np.array(robot.joint_lower), np.array(robot.joint_upper)
    beyond = np.maximum(clip.joint_position - upper, lower - clip.joint_position)
    return [
        at_most("joint beyond range (rad)", beyond.max(), 0.0),
        at_most("joint speed / limit", np.abs(clip.joint_velocity / np.array(robot.joint_speed_limit)).max(), 1.0),
    ]


def _gait(clip: Clip) -> list[ClipCheck]:
    steady = clip.split == "steady"
    measured = measure_gait(clip.foot_contact[None], clip.dt)
    frequency_error = abs(measured.frequency_hz[0] / clip.frequency_hz - 1.0)
    phase_error = pair_phase_errors(measured.phase[0], clip.gait).max()
    duty_error = abs(measured.duty[0].mean() - nominal_duty(clip.gait, clip.frequency_hz))
    flight_error = abs(measured.flight_fraction[0] - nominal_flight(clip.gait, clip.frequency_hz))
    return [
        at_most("frequency error", frequency_error, FREQUENCY_ERROR),
        at_most("phase error (strides)", phase_error, PHASE_ERROR if steady else DISTURBED_PHASE_ERROR),
        at_least("contact match", contact_match(clip), CONTACT_MATCH if steady else DISTURBED_CONTACT_MATCH),
        at_most("duty error (strides)", duty_error, DUTY_ERROR),
        at_most("flight error (strides)", flight_error, FLIGHT_ERROR),
    ]


def label_error(clip: Clip) -> float:
    """Root mean square distance in rad of the expert's answers from what the PD received."""
    return float(np.sqrt(np.mean((clip.joint_target - clip.joint_target_applied) ** 2)))


def stance_height(robot: Robot, clip: Clip) -> float:
    """Root mean square height in m above the floor of the feet that are said to stand."""
    above = np.maximum(foot_height(robot, clip)[clip.foot_contact], 0.0)
    return float(np.sqrt(np.mean(above**2))) if len(above) else 0.0


def stance_slip(clip: Clip) -> float:
    """Root mean square speed in m/s of the feet while they are said to stand."""
    turning = np.cross(clip.base_angular_velocity[:, None], clip.foot_position)
    velocity = clip.base_linear_velocity[:, None] + turning + clip.foot_velocity
    # A row in the midst of a stance: at touchdown and lift-off a foot moves by right.
    standing = clip.foot_contact[1:-1] & clip.foot_contact[:-2] & clip.foot_contact[2:]
    slip = np.sum(velocity[1:-1][standing] ** 2, axis=-1)
    return float(np.sqrt(slip.mean())) if len(slip) else 0.0


def contact_match(clip: Clip) -> float:
    """Fraction of rows and feet that follow the gait's schedule, at the best start of the stride."""
    starts = np.arange(0.0, 1.0 / clip.frequency_hz, 0.002)
    times = starts[:, None] + np.arange(len(clip)) * clip.dt
    scheduled = nominal_contact(clip.gait, clip.frequency_hz, times + 1e-9)
    return float((scheduled == clip.foot_contact).mean(axis=(1, 2)).max())


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
    mean = mean_velocity(heading_velocity(clip), clip.dt, clip.frequency_hz or None)
    error = velocity_error(clip.command, mean)
    return [
        at_most("speed error (m/s)", float(error.linear), SPEED_ERROR),
        at_most("turn error (rad/s)", float(error.angular), TURN_ERROR),
    ]


def replay_error(robot: Robot, clip: Clip) -> float:
    """RMS joint error in rad when the applied targets of the first half second are repeated open loop."""
    model = robot.load_model()
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
