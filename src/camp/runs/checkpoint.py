"""Checkpoints: written atomically, read without executing code.

A run folder keeps `checkpoints/checkpoint_00000123.pt`, one file per saved iteration; the latest is the one
with the highest number. A process killed at any moment leaves every finished checkpoint readable.
"""

from __future__ import annotations

import contextlib
import math
import re
import textwrap
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from camp.common.errors import CheckpointError
from camp.common.files import PARTIAL, whole_file
from camp.common.foreign import first_line, foreign_file
from camp.runs.folder import CHECKPOINTS

FORMAT = "camp-checkpoint"
FORMAT_VERSION = 1
MOST_UNPACKED = 2  # times the file's size; torch does not compress

_NAME = re.compile(r"checkpoint_(\d{8,})\.pt")
#: What reading entries of a state raises where it is not built as expected.
INCOMPATIBLE = (LookupError, RuntimeError, TypeError, ValueError, AttributeError, ArithmeticError)


def save_checkpoint(path: Path, state: Mapping[str, Any]) -> Path:
    """Write `state` to `path`, replacing what is there in one step.

    `state` may hold tensors, numbers, strings, None and dicts, lists and tuples of these: exactly what
    `torch.load(weights_only=True)` gives back. Anything else raises TypeError naming the entry.
    Raises CheckpointError when the disk is full or the folder not writable; an existing file stays as it was.
    """
    _check_plain(state, "state")
    try:
        with whole_file(path) as file:
            torch.save({"format": FORMAT, "version": FORMAT_VERSION, "state": dict(state)}, file)
    except (OSError, RuntimeError) as error:  # torch reports a full disk as RuntimeError
        raise CheckpointError(
            f"checkpoint {path}: could not be written ({first_line(error)}); free some space or choose another folder"
        ) from error
    return path


def save_run_checkpoint(
    run: Path, iteration: int, state: Mapping[str, Any], keep: int, best: int | None = None
) -> Path:
    """Save `state` as the run's checkpoint of `iteration` and delete all but the last `keep` (at least 1).

    best: an iteration whose checkpoint, this one or an earlier one, is kept besides.
    """
    path = save_checkpoint(run / CHECKPOINTS / f"checkpoint_{iteration:08d}.pt", state)
    for partial in path.parent.glob(f"*{PARTIAL}"):  # left by a process that was killed while writing
        partial.unlink(missing_ok=True)
    for old in list_checkpoints(run)[: -max(keep, 1)]:
        if old != path and _iteration(old) != best:
            old.unlink(missing_ok=True)
    return path


def list_checkpoints(run: Path) -> list[Path]:
    """The run's checkpoints, oldest first."""
    found = [path for path in (run / CHECKPOINTS).glob("checkpoint_*.pt") if _NAME.fullmatch(path.name)]
    return sorted(found, key=_iteration)


def latest_checkpoint(run: Path) -> Path:
    """The run's checkpoint with the highest iteration; CheckpointError when there is none."""
    if not run.is_dir():
        raise CheckpointError(f"run folder {run}: not found; name one of the folders that camp.train wrote")
    found = list_checkpoints(run)
    if not found:
        raise CheckpointError(
            f"run folder {run}: holds no {CHECKPOINTS}/checkpoint_*.pt; name a run that saved one, or train anew"
        )
    return found[-1]


def load_checkpoint(source: Path, device: torch.device | str = "cpu") -> dict[str, Any]:
    """The state in `source`, a checkpoint or a run folder (its latest), with all tensors on `device`.

    Raises CheckpointError in one line when it is missing, truncated, damaged, not camp's or of another
    version. Never falls back to an older file by itself, but names the last good one.
    """
    path = latest_checkpoint(source) if source.is_dir() or not source.suffix else source
    if not path.is_file():
        raise CheckpointError(f"checkpoint {path}: not found; name a run folder or a checkpoint_*.pt of one")
    try:
        return _read(path, device)
    except CheckpointError as error:
        good = next((candidate for candidate, _ in readable_before(path)), None)
        raise CheckpointError(f"{error}; {remedy(good)}") from error.__cause__


def incompatible(run: Path, error: Exception) -> CheckpointError:
    """What to raise where the networks of a run's configuration do not take the state of its checkpoint."""
    return CheckpointError(
        f"run folder {run}: its {latest_checkpoint(run).name} does not fit its config.yaml ({_what_differs(error)}); "
        "restore the original files, or train anew"
    )


def _read(path: Path, device: torch.device | str) -> dict[str, Any]:
    # As large as its networks: what it unpacks to is bounded instead.
    with foreign_file(
        path, f"checkpoint {path}: truncated, damaged or not a checkpoint", "", CheckpointError, largest=math.inf
    ):
        with zipfile.ZipFile(path) as archive:
            if sum(info.file_size for info in archive.infolist()) > MOST_UNPACKED * path.stat().st_size:
                raise ValueError("unpacks to many times its size")
            # torch does not compare the stored check sums: a flipped bit would pass as a weight.
            damaged = archive.testzip()
        if damaged is not None:
            raise zipfile.BadZipFile(f"wrong check sum of {damaged}")
        content = torch.load(path, map_location=device, weights_only=True, mmap=False)
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise CheckpointError(f"checkpoint {path}: not written by camp")
    if content.get("version") != FORMAT_VERSION:
        raise CheckpointError(
            f"checkpoint {path}: format version {content.get('version')}, this camp reads {FORMAT_VERSION}"
        )
    if not isinstance(content.get("state"), dict):
        raise CheckpointError(f"checkpoint {path}: holds no state")
    return content["state"]


def readable_before(path: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The run's checkpoints before `path` that can be read, newest first, each with its state on the CPU."""
    if not _NAME.fullmatch(path.name):
        return
    for candidate in reversed(list_checkpoints(path.parent.parent)):
        if _iteration(candidate) < _iteration(path):
            with contextlib.suppress(CheckpointError):
                yield candidate, _read(candidate, "cpu")


def remedy(good: Path | None) -> str:
    """What to do instead of reading a bad checkpoint, where `good` is the last good one before it."""
    if good is None:
        return "no good one lies before it: copy it again from where it came, or train anew"
    return f"the last good one before it is {good}; move the bad file away to continue from there"


def _iteration(path: Path) -> int:
    match = _NAME.fullmatch(path.name)
    assert match is not None, path
    return int(match[1])


def _check_plain(value: Any, where: str) -> None:
    if isinstance(value, Mapping):
        for key, item in value.items():
            _check_plain(item, f"{where}[{key!r}]")
    elif type(value) in (list, tuple):
        for index, item in enumerate(value):
            _check_plain(item, f"{where}[{index}]")
    elif not (value is None or isinstance(value, Tensor) or type(value) in (bool, int, float, str)):
        raise TypeError(f"{where} is a {type(value).__name__}: a checkpoint holds only tensors and plain values")


def _what_differs(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"no entry {error}"
    lines = str(error).strip().splitlines() or [type(error).__name__]
    # torch tells the network first and then, line by line, what differs: one example is enough.
    network = lines[0].removeprefix("Error(s) in loading state_dict for ")
    return textwrap.shorten(" ".join([network, *lines[1:2]]), 160, placeholder=" ...")
