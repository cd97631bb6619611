"""From a file to a clip: read, check, resample to 50 Hz, and estimate what the file does not contain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from camp.common.errors import ClipError
from camp.metrics.gait import measure_gait
from camp.motion.clips.clip import Clip
from camp.motion.clips.consistency import guard_checks
from camp.motion.exchange import amp, checks, kine2go, qpos
from camp.motion.exchange.feet import (
    check_feet,
    estimate_contact,
    feet_of,
    floor_heights,
    foot_heights,
    foot_velocities_of,
    world_foot_velocity,
)
from camp.motion.exchange.motion import CONTROL_RATE_HZ, ImportOptions, Motion, Velocities, derive_velocities
from camp.motion.exchange.rotations import rotate, slerp, yaw
from camp.motion.exchange.velocities import are_differences, check_velocities
from camp.robots.robot import Robot

_READERS: dict[str, Callable[[Path, ImportOptions], Motion]] = {
    "amp": amp.read_amp,
    "qpos": qpos.read_qpos,
    "kine2go": kine2go.read_kine2go,
}
FORMATS = tuple(_READERS)


def import_motion(path: Path, file_format: str, options: ImportOptions) -> Clip:
    """Read a motion of another project as a clip at 50 Hz.

    What the file does not hold: feet and their velocities follow from the joints; contact is estimated; the
    frequency is measured unless given; the command is the base's own velocity averaged over one stride unless
    given. Targets and torques are unknown: `has_targets` of the clip is False, the targets are the joint positions
    of the next row and the torques 0. Raises ClipError, naming the file, for everything that does not fit.
    """
    path = Path(path)
    options.check()
    if file_format not in FORMATS:
        raise ClipError(f"format {file_format!r}: pass one of {', '.join(FORMATS)}")
    if not path.is_file():
        raise ClipError(f"motion {path} does not exist; pass the path of a file")
    try:
        read = _READERS[file_format](path, options)
        motion = _checked(read, options)
        clip = _clip(motion, options, file_format)
        _refuse_inconsistent(options.robot, clip, motion.velocities is read.velocities)
        return clip
    except ClipError as error:
        raise ClipError(f"motion {path}: {error}") from error


def _refuse_inconsistent(robot: Robot, clip: Clip, own_velocities: bool) -> None:
    """What loading would refuse is not written in the first place. own_velocities: they are the file's."""
    failed = [str(check) for check in guard_checks(robot, clip) if not check.passed]
    if failed:
        remedy = "cut the motion to where it walks"
        if any("mismatch" in reason or "rate" in reason for reason in failed):
            remedy = "smooth the motion, or bring it with its velocities or at a higher rate"
            if own_velocities:
                remedy = "pass --derive-velocities, or smooth the motion"
        raise ClipError(f"{'; '.join(failed)}; {remedy}")


def _checked(motion: Motion, options: ImportOptions) -> Motion:
    """The motion with velocities, on the floor where asked for."""
    robot = options.robot
    checks.check_rate(motion)
    check_feet(robot, motion, options.trust_joints)
    checks.check_joint_range(robot, motion)
    checks.check_quaternion_order(robot, motion)
    if options.derive_velocities:
        motion = replace(motion, velocities=None)
    check_velocities(motion)
    if are_differences(motion):
        motion = replace(motion, velocities=None)  # nothing is lost, and they stand where they belong
    if options.ground:
        motion = _grounded(robot, motion)
    checks.check_floor(robot, motion)
    return replace(motion, velocities=motion.velocities or derive_velocities(motion))


def _grounded(robot: Robot, motion: Motion) -> Motion:
    height = foot_heights(motion.base_position, motion.base_quaternion, feet_of(robot, motion.joint_position))
    shift = np.array([0.0, 0.0, robot.leg.foot_radius - floor_heights(height).min()])
    return replace(motion, base_position=motion.base_position + shift)


def resample(motion: Motion, rate_hz: float = CONTROL_RATE_HZ) -> Motion:
    """The motion at another rate: orientation along the arc, everything else linearly; feet are left out."""
    duration = (len(motion) - 1) / motion.rate_hz
    times = np.arange(int(duration * rate_hz + 1e-6) + 1) / rate_hz  # the last one not beyond the file's
    if len(times) < 2:
        raise ClipError(f"the motion lasts {duration:.3f} s; at least two rows at {rate_hz:g} Hz are needed")
    place = times * motion.rate_hz
    nearest = np.round(place)
    place = np.where(np.abs(place - nearest) < 1e-6, nearest, place)  # equal rates: every frame as it is
    row = np.minimum(place.astype(int), len(motion) - 2)
    fraction = (place - row)[:, None]

    def between(values: np.ndarray) -> np.ndarray:
        return (1.0 - fraction) * values[row] + fraction * values[row + 1]

    velocities = motion.velocities or derive_velocities(motion)
    quaternion = motion.base_quaternion
    return Motion(
        rate_hz=rate_hz,
        base_position=between(motion.base_position),
        base_quaternion=slerp(quaternion[row], quaternion[row + 1], fraction),
        joint_position=between(motion.joint_position),
        velocities=Velocities(*(between(values) for values in vars(velocities).values())),
    )


def _clip(motion: Motion, options: ImportOptions, file_format: str) -> Clip:
    robot, motion = options.robot, resample(motion)
    velocities = motion.velocities
    assert velocities is not None
    foot_position = feet_of(robot, motion.joint_position)
    height = foot_heights(motion.base_position, motion.base_quaternion, foot_position)
    contact = estimate_contact(height, world_foot_velocity(robot, motion, velocities, foot_position))
    frequency = _stride_frequency(contact) if options.frequency_hz is None else options.frequency_hz
    next_position = np.concatenate([motion.joint_position[1:], motion.joint_position[-1:]])

    def single(values: np.ndarray) -> np.ndarray:
        return values.astype(np.float32)

    return Clip(
        dt=1.0 / CONTROL_RATE_HZ,
        gait=options.gait,
        frequency_hz=frequency,
        command=single(np.array(options.command) if options.command else _mean_twist(motion, frequency)),
        base_position=single(motion.base_position - motion.base_position[0] * [1.0, 1.0, 0.0]),
        base_quaternion=single(motion.base_quaternion),
        joint_position=single(motion.joint_position),
        joint_velocity=single(velocities.joint),
        base_linear_velocity=single(velocities.base_linear),
        base_angular_velocity=single(velocities.base_angular),
        foot_position=single(foot_position),
        foot_velocity=single(foot_velocities_of(robot, motion.joint_position, velocities.joint)),
        foot_contact=contact,
        joint_target=single(next_position),
        joint_target_applied=single(next_position),
        joint_torque=single(np.zeros_like(next_position)),
        split="steady" if options.command else "varied",
        source=file_format,
    )


def _stride_frequency(contact: np.ndarray) -> float:
    frequency = float(measure_gait(contact[None], 1.0 / CONTROL_RATE_HZ).frequency_hz[0])
    if not np.isfinite(frequency):
        raise ClipError(
            f"no stride frequency can be measured: in {len(contact)} rows the feet do not step regularly "
            f"(duty {', '.join(f'{duty:.2f}' for duty in contact.mean(axis=0))}); pass --frequency HZ"
        )
    return frequency


def _mean_twist(motion: Motion, frequency_hz: float) -> np.ndarray:
    """Velocity (T, 3) in the heading frame, averaged over the stride around each row: vx, vy m/s, wz rad/s."""
    assert motion.velocities is not None
    world = rotate(motion.base_quaternion, motion.velocities.base_linear)
    turn = rotate(motion.base_quaternion, motion.velocities.base_angular)[:, 2]
    heading = yaw(motion.base_quaternion)
    cosine, sine = np.cos(heading), np.sin(heading)
    twist = [cosine * world[:, 0] + sine * world[:, 1], cosine * world[:, 1] - sine * world[:, 0], turn]
    half = max(1, round(motion.rate_hz / frequency_hz / 2))
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(np.stack(twist, axis=1), axis=0)])
    row = np.arange(len(motion))
    first, last = np.maximum(row - half, 0), np.minimum(row + half, len(motion))
    return (total[last] - total[first]) / (last - first)[:, None]
