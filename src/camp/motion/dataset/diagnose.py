"""Diagnosis of a failed clip: which of the usual mix-ups in legged-robot files explains it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from camp.metrics.gait import NO_GAIT, measure_gait
from camp.motion.clips.clip import Clip
from camp.motion.clips.consistency import RATE_ERROR, fitting_period, foot_height, guard_checks
from camp.motion.dataset.validate import label_error, replay_error
from camp.robots.quadruped import FOOT_NAMES
from camp.robots.robot import Robot

_LEG_ORDERS = ([1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0])
_LARGEST_SHIFT = 25  # rows, half a second
_ON_FLOOR = 0.001  # m, below which a foot stands
_JOINTS = ("joint_position", "joint_velocity", "joint_target", "joint_target_applied", "joint_torque")
_FEET = ("foot_position", "foot_velocity", "foot_contact")
_LEG_GROUPS = {
    "all": (*_JOINTS, *_FEET),
    "joint": _JOINTS,
    "foot": _FEET,
    "joint_velocity": ("joint_velocity",),
    "foot_velocity": ("foot_velocity",),
}


def find_cause(robot: Robot, clip: Clip) -> str | None:
    """The mix-up that explains why the clip fails, or None."""
    if not _is_consistent(robot, clip):
        return _wrong_rate(robot, clip) or _wrong_quaternion(robot, clip) or _swapped_legs(robot, clip)
    return _shifted_labels(robot, clip) or _wrong_gait(clip)


def _is_consistent(robot: Robot, clip: Clip) -> bool:
    return all(check.passed for check in guard_checks(robot, clip))


def _wrong_rate(robot: Robot, clip: Clip) -> str | None:
    period = fitting_period(clip)
    if abs(period / clip.dt - 1.0) <= RATE_ERROR or period <= 0.0:
        return None
    if not _is_consistent(robot, replace(clip, dt=period)):
        return None
    return f"wrong rate: dt is {clip.dt:g} s, positions and velocities fit {period:.3f} s"


def _wrong_quaternion(robot: Robot, clip: Clip) -> str | None:
    if not _is_consistent(robot, replace(clip, base_quaternion=clip.base_quaternion[:, [3, 0, 1, 2]])):
        return None
    return "wrong quaternion order: base_quaternion reads as x, y, z, w; w comes first"


def _swapped_legs(robot: Robot, clip: Clip) -> str | None:
    """Of the orders that make the clip consistent the one that fits best: diagonal legs of a trot move alike."""
    disagreement = {}
    for order in _LEG_ORDERS:
        for group, names in _LEG_GROUPS.items():
            sorted_legs = replace(clip, **{name: _reordered(getattr(clip, name), order) for name in names})
            if _is_consistent(robot, sorted_legs):
                disagreement[group, tuple(order)] = _disagreement(robot, sorted_legs)
    if not disagreement:
        return None
    group, order = min(disagreement, key=lambda key: disagreement[key])
    legs = ", ".join(FOOT_NAMES[leg] for leg in order)
    return f"swapped legs: {group} values are in the order {legs}, expected {', '.join(FOOT_NAMES)}"


def _disagreement(robot: Robot, clip: Clip) -> float:
    """How far joints and feet are from agreeing, in fractions of the limits."""
    checks = [check for check in guard_checks(robot, clip) if check.name.startswith(("joint", "foot"))]
    return sum(check.value / check.limit for check in checks)


def _reordered(values: np.ndarray, order: list[int]) -> np.ndarray:
    return values.reshape(len(values), 4, -1)[:, order].reshape(values.shape)


def _shifted_labels(robot: Robot, clip: Clip) -> str | None:
    """An array whose rows belong to other rows of the motion."""
    distances = {
        "foot_contact": lambda moved: float((moved.foot_contact != (foot_height(robot, moved) < _ON_FLOOR)).mean()),
        "joint_target_applied": partial(replay_error, robot),
        "joint_target": label_error,
    }
    largest = min(_LARGEST_SHIFT, (len(clip) - 2) // 2)
    shifts = range(-largest, largest + 1)
    for name, distance in distances.items():
        if not clip.has_targets and name != "foot_contact":
            continue
        distance_by_shift = {shift: distance(_shifted(clip, name, shift, largest)) for shift in shifts}
        smallest = min(distance_by_shift.values())
        fitting = [shift for shift in shifts if distance_by_shift[shift] <= 1.5 * smallest]
        best = min(fitting, key=abs)  # a periodic motion fits again a stride later
        if best and smallest < distance_by_shift[0] / 2:
            return f"shifted labels: {name} is {abs(best)} rows {'late' if best > 0 else 'early'}"
    return None


def _shifted(clip: Clip, name: str, rows: int, margin: int) -> Clip:
    """The clip without `margin` rows at either end, one array taken `rows` later than the others."""
    end = len(clip) - margin
    arrays = {
        key: values[margin:end]
        for key, values in vars(clip).items()
        if isinstance(values, np.ndarray) and len(values) == len(clip)
    }
    arrays[name] = getattr(clip, name)[margin + rows : end + rows]
    return replace(clip, **arrays)


def _wrong_gait(clip: Clip) -> str | None:
    measured = measure_gait(clip.foot_contact[None], clip.dt).label[0]
    if clip.split not in ("steady", "varied", "recovery") or measured in (clip.gait, NO_GAIT):
        return None
    return f"wrong label: gait is {clip.gait}, the feet show a {measured}"
