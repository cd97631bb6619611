"""The clip format: one expert motion per .npz file, and everything a loaded file must satisfy.

Legs are FL, FR, RL, RR and joints hip, thigh, calf of each leg; quaternions have w first; T control steps.
Row t holds the state in which `joint_target[t]` was given.
"""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from camp.errors import ClipError
from camp.motion.gaits import GAIT_PHASES
from camp.robots.go2 import FOOT_NAMES, JOINT_NAMES

REGENERATE = "generate it again with `python -m camp.dataset`"

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
_NAMES = {"joint_names": JOINT_NAMES, "foot_names": FOOT_NAMES}
_QUATERNION_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Clip:
    """One motion of T control steps. Arrays are float32 unless said otherwise."""

    dt: float  # s between rows
    gait: str
    frequency_hz: float  # stride frequency asked for
    command: np.ndarray  # (3,) vx, vy in m/s and yaw rate in rad/s; (T, 3) where it changes
    base_position: np.ndarray  # (T, 3) m, world
    base_quaternion: np.ndarray  # (T, 4) base to world
    joint_position: np.ndarray  # (T, 12) rad
    joint_velocity: np.ndarray  # (T, 12) rad/s
    base_linear_velocity: np.ndarray  # (T, 3) m/s, base frame
    base_angular_velocity: np.ndarray  # (T, 3) rad/s, base frame
    foot_position: np.ndarray  # (T, 4, 3) m, base frame, centre of the foot's sphere
    foot_velocity: np.ndarray  # (T, 4, 3) m/s, time derivative of foot_position
    foot_contact: np.ndarray  # (T, 4) bool
    joint_target: np.ndarray  # (T, 12) rad, the expert's answer to this state
    joint_target_applied: np.ndarray  # (T, 12) rad, what the PD controller received
    joint_torque: np.ndarray  # (T, 12) N m, mean over the control step that follows
    joint_names: tuple[str, ...] = JOINT_NAMES
    foot_names: tuple[str, ...] = FOOT_NAMES

    def __len__(self) -> int:
        return len(self.joint_position)

    @property
    def is_steady(self) -> bool:
        """Whether the command is one twist held throughout, so that means and phases can be judged."""
        return self.command.ndim == 1


def amp_state(clip: Clip) -> np.ndarray:
    """States of the discriminators, (T, 43) float32, raw SI units (paper, Sec. III-C, in its order).

    Joint positions 12, joint velocities 12, base linear velocity 3, base angular velocity 3, base height 1,
    foot positions 12.
    """
    parts = [
        clip.joint_position,
        clip.joint_velocity,
        clip.base_linear_velocity,
        clip.base_angular_velocity,
        clip.base_position[:, 2:],
        clip.foot_position.reshape(len(clip), 12),
    ]
    return np.concatenate(parts, axis=1).astype(np.float32)


def save_clip(path: Path, clip: Clip) -> None:
    """Write a clip, compressed. The file appears under its name only when it is complete."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    arrays: dict[str, Any] = {field.name: np.asarray(getattr(clip, field.name)) for field in fields(Clip)}
    arrays |= {name: np.float32(arrays[name]) for name in ("dt", "frequency_hz")}
    with temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)
    temporary.replace(path)


def load_clip(path: Path) -> Clip:
    """Read and check one clip.

    Raises ClipError, naming the file and what is wrong: missing file, unreadable or truncated archive,
    pickled content, missing key, wrong shape, dtype or names, values that are not finite, quaternions that
    are not unit.
    """
    path = Path(path)
    if not path.is_file():
        raise ClipError(f"clip {path} does not exist; {REGENERATE}")
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (ValueError, TypeError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise ClipError(f"clip {path} cannot be read ({reason}); {REGENERATE}") from error
    problem = _find_problem(arrays)
    if problem:
        raise ClipError(f"clip {path}: {problem}; {REGENERATE}")
    values: dict[str, Any] = {field.name: arrays[field.name] for field in fields(Clip)}
    values |= {
        "dt": round(float(arrays["dt"]), 6),  # .02 is no float32
        "frequency_hz": float(arrays["frequency_hz"]),
        "gait": str(arrays["gait"]),
    }
    values |= {name: tuple(arrays[name].tolist()) for name in _NAMES}
    return Clip(**values)


def load_clips(folder: Path, skills: Sequence[str]) -> list[Clip]:
    """Clips of the given gaits in a folder, in the order of their file names.

    Raises ClipError where the folder is missing or empty, a file is wrong or a skill has no clip.
    """
    folder = Path(folder)
    paths = sorted(folder.glob("*.npz")) if folder.is_dir() else []
    if not paths:
        raise ClipError(f"no clips in {folder}; generate them with `python -m camp.dataset`")
    clips = [load_clip(path) for path in paths]
    for skill in skills:
        if not any(clip.gait == skill for clip in clips):
            found = ", ".join(sorted({clip.gait for clip in clips}))
            raise ClipError(
                f"skill '{skill}' has no clip in {folder} (found: {found}); "
                "generate some with `python -m camp.dataset` or take it out of motion.skills"
            )
    return [clip for clip in clips if clip.gait in skills]


def _find_problem(arrays: dict[str, np.ndarray]) -> str | None:
    """What is wrong with the arrays of a clip file, or None."""
    missing = [field.name for field in fields(Clip) if field.name not in arrays]
    if missing:
        return f"key '{missing[0]}' is missing"
    steps = arrays["joint_position"].shape[0] if arrays["joint_position"].ndim else 0
    if steps < 2:
        return f"'joint_position' has {steps} rows, at least 2 are needed"
    shapes = {name: (steps, *tail) for name, tail in _ROWS.items()}
    shapes |= {name: (len(expected),) for name, expected in _NAMES.items()}
    shapes |= dict.fromkeys(("dt", "gait", "frequency_hz"), ())
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            return f"'{name}' has shape {arrays[name].shape}, expected {shape}"
    if arrays["command"].shape not in ((3,), (steps, 3)):
        return f"'command' has shape {arrays['command'].shape}, expected (3,) or {(steps, 3)}"
    for name, array in arrays.items():
        kind = "b" if name == "foot_contact" else "U" if name in (*_NAMES, "gait") else "f"
        if array.dtype.kind != kind:
            return f"'{name}' has dtype {array.dtype}, expected kind '{kind}'"
        if kind == "f" and not np.isfinite(array).all():
            return f"'{name}' holds values that are not finite"
    for name, expected in _NAMES.items():
        if tuple(arrays[name].tolist()) != expected:
            return f"'{name}' is {arrays[name].tolist()}, expected {list(expected)}"
    if str(arrays["gait"]) not in GAIT_PHASES:
        return f"'gait' is {str(arrays['gait'])!r}, expected one of {list(GAIT_PHASES)}"
    for name in ("dt", "frequency_hz"):
        if arrays[name] <= 0.0:
            return f"'{name}' is {arrays[name]}, expected more than 0"
    norm = np.linalg.norm(arrays["base_quaternion"], axis=1)
    if np.abs(norm - 1.0).max() > _QUATERNION_TOLERANCE:
        return f"'base_quaternion' has norms from {norm.min():.3f} to {norm.max():.3f}, expected 1"
    return None
