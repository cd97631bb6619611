"""The clip format: one expert motion per .npz file, and everything a loaded file must satisfy.

Legs are FL, FR, RL, RR and joints hip, thigh, calf of each leg; quaternions have w first; T control steps.
Row t holds the state in which `joint_target[t]` was given. Files without the keys that have a default below
(older ones) are read as well.
"""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from camp.common.errors import ClipError
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import SPLITS, STAND, TRAINING_SPLITS, Clip
from camp.motion.clips.consistency import guard_checks
from camp.motion.clips.mirror import mirrored
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
_TEXTS = ("gait", "split", "previous_gait", "source")
_COUNTS = ("seed", "switch_step")
_NAMES = {"joint_names": JOINT_NAMES, "foot_names": FOOT_NAMES}
_OPTIONAL = ("split", "seed", "previous_gait", "switch_step", "source")
# Kind of dtype where it is not floating point.
_KINDS = {"foot_contact": "b"} | dict.fromkeys((*_TEXTS, *_NAMES), "U") | dict.fromkeys(_COUNTS, "i")
_QUATERNION_TOLERANCE = 1e-3


_FIELDS = tuple(field.name for field in fields(Clip))


def save_clip(path: Path, clip: Clip) -> None:
    """Write a clip, compressed. The file appears under its name only when it is complete."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    arrays: dict[str, Any] = {name: np.asarray(getattr(clip, name)) for name in _FIELDS}
    arrays |= {name: np.float32(arrays[name]) for name in ("dt", "frequency_hz")}
    arrays |= {name: np.int64(arrays[name]) for name in _COUNTS}
    with temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)
    temporary.replace(path)


def load_clip(path: Path) -> Clip:
    """Read and check one clip.

    Raises ClipError, naming the file and what is wrong: missing file, unreadable or truncated archive,
    pickled content, missing key, wrong shape, dtype or names, values that are not finite, quaternions that
    are not unit.
    """
    arrays = _read(path)
    problem = _find_problem(arrays)
    if problem:
        raise ClipError(f"clip {path}: {problem}; {REGENERATE}")
    values: dict[str, Any] = {name: arrays[name] for name in arrays if name in _FIELDS}
    values |= {
        "dt": round(float(arrays["dt"]), 6),  # .02 is no float32
        "frequency_hz": float(arrays["frequency_hz"]),
        "split": _split(arrays),
    }
    values |= {name: str(arrays[name]) for name in ("gait", "previous_gait", "source") if name in arrays}
    values |= {name: int(arrays[name]) for name in _COUNTS if name in arrays}
    values |= {name: tuple(arrays[name].tolist()) for name in _NAMES}
    return Clip(**values)


def load_clips(
    folder: Path, skills: Sequence[str], splits: Sequence[str] = TRAINING_SPLITS, with_mirrored: bool = False
) -> list[Clip]:
    """Clips of the given gaits and splits in a folder, in the order of their file names.

    with_mirrored: each clip is followed by its mirror image. Clips that do not move as they say (see
    camp.motion.clips.consistency) are refused. Raises ClipError where the folder is missing or empty, a split is
    unknown, a file is wrong or a skill has no clip.
    """
    unknown = [split for split in splits if split not in SPLITS]
    if unknown:
        raise ClipError(f"split '{unknown[0]}' is unknown; choose from {', '.join(SPLITS)}")
    folder = Path(folder)
    paths = sorted(folder.glob("*.npz")) if folder.is_dir() else []
    if not paths:
        raise ClipError(f"no clips in {folder}; generate them with `python -m camp.dataset`")
    labels = {path: clip_label(path) for path in paths}
    gaits = {gait for gait, split in labels.values() if split in splits}
    for skill in skills:
        if skill not in gaits:
            raise ClipError(
                f"skill '{skill}' has no clip in {folder} (found: {', '.join(sorted(gaits))}); "
                "generate some with `python -m camp.dataset` or take it out of motion.skills"
            )
    clips = []
    for path, (gait, split) in labels.items():
        if gait in skills and split in splits:
            clip = load_clip(path)
            _refuse_inconsistent(path, clip)
            clips += [clip, mirrored(clip)] if with_mirrored else [clip]
    return clips


def clip_label(path: Path) -> tuple[str, str]:
    """Gait and split of a clip file, without reading its motion. Raises ClipError as `load_clip` does."""
    arrays = _read(path, ("gait", "split", "command"))
    missing = [name for name in ("gait", "command") if name not in arrays]
    if missing:
        raise ClipError(f"clip {path}: key '{missing[0]}' is missing; {REGENERATE}")
    return str(arrays["gait"]), _split(arrays)


def _read(path: Path, names: Sequence[str] | None = None) -> dict[str, np.ndarray]:
    """The arrays of a file, or those of the given names that it has."""
    path = Path(path)
    if not path.is_file():
        raise ClipError(f"clip {path} does not exist; {REGENERATE}")
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files if names is None or name in names}
    except (ValueError, TypeError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise ClipError(f"clip {path} cannot be read ({reason}); {REGENERATE}") from error


def _split(arrays: dict[str, np.ndarray]) -> str:
    """The split. Files older than splits hold steady clips or, where the command changes, perturbed ones."""
    if "split" in arrays:
        return str(arrays["split"])
    return "steady" if arrays["command"].ndim == 1 else "perturbed"


def _refuse_inconsistent(path: Path, clip: Clip) -> None:
    failed = [str(check) for check in guard_checks(clip) if not check.passed]
    if failed:
        raise ClipError(
            f"clip {path}: {'; '.join(failed)}; see what is wrong with `python -m camp.dataset validate {path.parent}`"
        )


def _find_problem(arrays: dict[str, np.ndarray]) -> str | None:
    """What is wrong with the arrays of a clip file, or None."""
    missing = [name for name in _FIELDS if name not in arrays and name not in _OPTIONAL]
    if missing:
        return f"key '{missing[0]}' is missing"
    steps = arrays["joint_position"].shape[0] if arrays["joint_position"].ndim else 0
    if steps < 2:
        return f"'joint_position' has {steps} rows, at least 2 are needed"
    shapes = {name: (steps, *tail) for name, tail in _ROWS.items()}
    shapes |= {name: (len(expected),) for name, expected in _NAMES.items()}
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
    for name, expected in _NAMES.items():
        if tuple(arrays[name].tolist()) != expected:
            return f"'{name}' is {arrays[name].tolist()}, expected {list(expected)}"
    return _find_wrong_label(arrays, steps) or _find_wrong_quaternion(arrays["base_quaternion"])


def _find_wrong_label(arrays: dict[str, np.ndarray], steps: int) -> str | None:
    gait, split = str(arrays["gait"]), _split(arrays)
    if gait not in (*GAIT_PHASES, STAND):
        return f"'gait' is {gait!r}, expected one of {[*GAIT_PHASES, STAND]}"
    if split not in SPLITS:
        return f"'split' is {split!r}, expected one of {list(SPLITS)}"
    if (gait == STAND) != (split == STAND):
        return f"'gait' is {gait!r} and 'split' {split!r}: standing clips have both, others neither"
    if not arrays["dt"] > 0.0:
        return f"'dt' is {arrays['dt']}, expected more than 0"
    if (arrays["frequency_hz"] > 0.0) == (gait == STAND):
        return f"'frequency_hz' is {arrays['frequency_hz']}, expected more than 0, or 0 for standing"
    if not 0 <= int(arrays.get("switch_step", 0)) < steps:
        return f"'switch_step' is {arrays['switch_step']}, expected a row, 0 to {steps - 1}"
    return None


def _find_wrong_quaternion(quaternion: np.ndarray) -> str | None:
    norm = np.linalg.norm(quaternion, axis=1)
    if np.abs(norm - 1.0).max() > _QUATERNION_TOLERANCE:
        return f"'base_quaternion' has norms from {norm.min():.3f} to {norm.max():.3f}, expected 1"
    return None
