"""What the arrays of a clip file must be: keys, shapes, types, labels in their ranges."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import FREQUENCY_RANGE_HZ
from camp.motion.clips.clip import SPLITS, STAND, Clip
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES

PERIOD_RANGE_S = (0.001, 0.1)  # between rows

# Trailing shape of every array that has one row per control step.
_ROWS: dict[str, tuple[int, ...]] = {
    "base_position": (3,),
    "base_quaternion": (4,),
    "joint_position": (12,),
    "joint_velocity": (12,),
    "base_linear_velocity": (3,),
    "base_angular_velocity": (3,),
    "foot_position": (4, 3),
    "foot_velocity": (4, 3),
    "foot_contact": (4,),
    "joint_target": (12,),
    "joint_target_applied": (12,),
    "joint_torque": (12,),
}
_TEXTS = ("gait", "split", "previous_gait", "source")
COUNTS = ("seed", "switch_step")
NAMES = {"joint_names": JOINT_NAMES, "foot_names": FOOT_NAMES}
_OPTIONAL = ("split", "seed", "previous_gait", "switch_step", "source")
# Kind of dtype where it is not floating point.
_KINDS = {"foot_contact": "b"} | dict.fromkeys((*_TEXTS, *NAMES), "U") | dict.fromkeys(COUNTS, "i")
_QUATERNION_TOLERANCE = 1e-3


# Keys of a clip file; `foot_stance` is computed after loading.
FIELDS = tuple(field.name for field in fields(Clip) if field.name != "foot_stance")


def find_problem(arrays: dict[str, np.ndarray]) -> str | None:
    """What is wrong with the arrays of a clip file, or None."""
    missing = [name for name in FIELDS if name not in arrays and name not in _OPTIONAL]
    if missing:
        return f"key '{missing[0]}' is missing"
    steps = arrays["joint_position"].shape[0] if arrays["joint_position"].ndim else 0
    if steps < 2:
        return f"'joint_position' has {steps} rows, at least 2 are needed"
    shapes = {name: (steps, *tail) for name, tail in _ROWS.items()}
    shapes |= {name: (len(expected),) for name, expected in NAMES.items()}
    shapes |= dict.fromkeys(("dt", "gait", "frequency_hz", *_OPTIONAL), ())
    for name, shape in shapes.items():
        if name in arrays and arrays[name].shape != shape:
            return f"'{name}' has shape {arrays[name].shape}, expected {shape}"
    if arrays["command"].shape not in ((3,), (steps, 3)):
        return f"'command' has shape {arrays['command'].shape}, expected (3,) or {(steps, 3)}"
    for name, array in arrays.items():
        kind = _KINDS.get(name, "f")
        if array.dtype.kind != kind:
            return f"'{name}' has dtype {array.dtype}, expected kind '{kind}'"
        if kind == "f" and not np.isfinite(array).all():
            return f"'{name}' holds values that are not finite"
    for name, expected in NAMES.items():
        if tuple(arrays[name].tolist()) != expected:
            return f"'{name}' is {arrays[name].tolist()}, expected {list(expected)}"
    return _find_wrong_label(arrays, steps) or _find_wrong_quaternion(arrays["base_quaternion"])


def _find_wrong_label(arrays: dict[str, np.ndarray], steps: int) -> str | None:
    gait, split = str(arrays["gait"]), split_of(arrays)
    if gait not in (*GAIT_PHASES, STAND):
        return f"'gait' is {gait!r}, expected one of {[*GAIT_PHASES, STAND]}"
    if split not in SPLITS:
        return f"'split' is {split!r}, expected one of {list(SPLITS)}"
    if (gait == STAND) != (split == STAND):
        return f"'gait' is {gait!r} and 'split' {split!r}: standing clips have both, others neither"
    if not _is_within(float(arrays["dt"]), PERIOD_RANGE_S):
        return f"'dt' is {arrays['dt']} s, expected {PERIOD_RANGE_S[0]:g} to {PERIOD_RANGE_S[1]:g}"
    frequency = float(arrays["frequency_hz"])
    if not (frequency == 0.0 if gait == STAND else _is_within(frequency, FREQUENCY_RANGE_HZ)):
        low, high = FREQUENCY_RANGE_HZ
        return f"'frequency_hz' is {frequency:g}, expected {low:g} to {high:g}, or 0 for standing"
    if not 0 <= int(arrays.get("switch_step", 0)) < steps:
        return f"'switch_step' is {arrays['switch_step']}, expected a row, 0 to {steps - 1}"
    return None


def _is_within(value: float, bounds: tuple[float, float]) -> bool:
    """Whether a value that went through float32 lies between the bounds."""
    return bounds[0] * (1.0 - 1e-6) <= value <= bounds[1] * (1.0 + 1e-6)


def _find_wrong_quaternion(quaternion: np.ndarray) -> str | None:
    norm = np.linalg.norm(quaternion, axis=1)
    if np.abs(norm - 1.0).max() > _QUATERNION_TOLERANCE:
        return f"'base_quaternion' has norms from {norm.min():.3f} to {norm.max():.3f}, expected 1"
    return None


def split_of(arrays: dict[str, np.ndarray]) -> str:
    """The split. Files older than splits hold steady clips or, where the command changes, perturbed ones."""
    if "split" in arrays:
        return str(arrays["split"])
    return "steady" if arrays["command"].ndim == 1 else "perturbed"
