"""The clip format: one expert motion per .npz file, and everything that a loaded file must satisfy.

Files without the keys that have a default (older ones) are read as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from camp.common.archive import read_arrays
from camp.common.commands import command
from camp.common.errors import ClipError
from camp.common.files import whole_file
from camp.common.foreign import foreign_file
from camp.gaits.skills import Skill
from camp.motion.clips.clip import SPLITS, TRAINING_SPLITS, Clip
from camp.motion.clips.consistency import guard_checks
from camp.motion.clips.layout import COUNTS, FIELDS, NAMES, find_problem, split_of
from camp.motion.clips.mirror import with_images
from camp.motion.clips.selection import ClipLabel, select
from camp.robots.robot import Robot

REGENERATE = "generate it again with `python -m camp.dataset`"


def save_clip(path: Path, clip: Clip) -> None:
    """Write a clip, compressed. The file is read back before it takes its name, and the place of what is there.

    Raises ClipError for a clip that could not be loaded again, and where the folder or the disk cannot take it.
    """
    arrays: dict[str, Any] = {name: np.asarray(getattr(clip, name)) for name in FIELDS}
    arrays |= {name: np.float32(arrays[name]) for name in ("dt", "frequency_hz")}
    arrays |= {name: np.int64(arrays[name]) for name in COUNTS}

    def read_back(written: Path) -> None:
        problem = find_problem(_read(written))
        if problem:
            raise ClipError(f"clip {path}: not written, for it could not be loaded ({problem})")

    try:
        with whole_file(Path(path), read_back) as file:
            np.savez_compressed(file, **arrays)
    except OSError as error:
        raise ClipError(
            f"clip {path}: cannot be written ({error.strerror or error}); free some space or choose another folder"
        ) from error


def load_clip(path: Path) -> Clip:
    """Read and check one clip.

    Raises ClipError, naming the file and what is wrong: missing file, unreadable or truncated archive,
    pickled content, missing key, wrong shape, dtype or names, values that are not finite, quaternions that
    are not unit.
    """
    arrays = _read(path)
    problem = find_problem(arrays)
    if problem:
        raise ClipError(f"clip {path}: {problem}; {REGENERATE}")
    values: dict[str, Any] = {name: arrays[name] for name in arrays if name in FIELDS}
    # .02 and 1.8 are no float32
    values |= {name: round(float(arrays[name]), 6) for name in ("dt", "frequency_hz")}
    values["split"] = split_of(arrays)
    values |= {name: str(arrays[name]) for name in ("gait", "previous_gait", "source") if name in arrays}
    values |= {name: int(arrays[name]) for name in COUNTS if name in arrays}
    values |= {name: tuple(arrays[name].tolist()) for name in NAMES}
    return Clip(**values)


def load_clips(
    robot: Robot,
    folder: Path,
    skills: Sequence[str],
    splits: Sequence[str] = TRAINING_SPLITS,
    with_mirrored: bool = False,
) -> list[Clip]:
    """Clips of a robot's given gaits and splits in a folder, at any stride frequency, in the order of their file names.

    with_mirrored: each clip is followed by its mirror image. Clips that do not move as they say, or as
    this robot can (see camp.motion.clips.consistency), are refused. Raises ClipError where the folder is missing or
    empty, a split is unknown, a file is wrong or a skill has no clip.
    """
    unknown = [split for split in splits if split not in SPLITS]
    if unknown:
        raise ClipError(f"split '{unknown[0]}' is unknown; choose from {', '.join(SPLITS)}")
    labels = _labels(robot, folder)
    gaits = {label.gait for label in labels.values() if label.split in splits}
    for skill in skills:
        if skill not in gaits:
            raise ClipError(
                f"skill '{skill}' has no clip in {folder} (found: {', '.join(sorted(gaits))}); "
                f"generate some with `{_generation(robot, folder)}` or take it out of motion.skills"
            )
    chosen = [path for path, label in labels.items() if label.gait in skills and label.split in splits]
    clips = _load(robot, chosen)
    return with_images(clips) if with_mirrored else clips


def load_skill_clips(
    robot: Robot,
    folder: Path,
    skills: Sequence[Skill],
    frequencies_hz: Sequence[float],
) -> list[Clip]:
    """Clips of a robot for training: of the skills and, whatever their labels, near one of the stride frequencies.

    Otherwise as `load_clips`. Raises ClipError where a skill has none; it lists what the folder holds, and what to
    ask for instead.
    """
    return _load(robot, select(folder, _labels(robot, folder), skills, frequencies_hz))


def clip_label(path: Path) -> ClipLabel:
    """What a clip file says it shows, without reading its motion. Raises ClipError as `load_clip` does."""
    arrays = _read(path, ["gait", "split", "command", "frequency_hz"])
    for name in ("gait", "command", "frequency_hz"):
        if name not in arrays:
            raise ClipError(f"clip {path}: key '{name}' is missing; {REGENERATE}")
    frequency = arrays["frequency_hz"]
    if frequency.shape != () or frequency.dtype.kind != "f":
        raise ClipError(f"clip {path}: 'frequency_hz' is no single number; {REGENERATE}")
    return ClipLabel(str(arrays["gait"]), split_of(arrays), round(float(frequency), 6))


def _labels(robot: Robot, folder: Path) -> dict[Path, ClipLabel]:
    folder = Path(folder)
    paths = sorted(folder.glob("*.npz")) if folder.is_dir() else []
    if not paths:
        raise ClipError(f"no clips in {folder}; generate them with `{_generation(robot, folder)}`")
    return {path: clip_label(path) for path in paths}


def _generation(robot: Robot, folder: Path) -> str:
    """The command that makes a robot's clips in a folder."""
    return command("camp.dataset", "--robot", robot.name, "--folder", str(folder))


def _load(robot: Robot, paths: Sequence[Path]) -> list[Clip]:
    clips = []
    for path in paths:
        clip = load_clip(path)
        _refuse_inconsistent(robot, path, clip)
        clips.append(clip)
    return clips


def _read(path: Path, names: Sequence[str] | None = None) -> dict[str, np.ndarray]:
    """The arrays of a file, or those of the given names that it has."""
    path = Path(path)
    if not path.is_file():
        raise ClipError(f"clip {path} does not exist; {REGENERATE}")
    with foreign_file(path, f"clip {path} cannot be read", REGENERATE, ClipError):
        return read_arrays(path, names)


def _refuse_inconsistent(robot: Robot, path: Path, clip: Clip) -> None:
    failed = [str(check) for check in guard_checks(robot, clip) if not check.passed]
    if failed:
        raise ClipError(
            f"clip {path}: {'; '.join(failed)}; see what is wrong with "
            f"`{command('camp.dataset', 'validate', str(path.parent))}`"
        )
