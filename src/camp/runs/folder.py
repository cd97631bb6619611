"""The run folder: the names of its files, and the creation of new run folders."""

from __future__ import annotations

import contextlib
import tempfile
from datetime import datetime
from pathlib import Path

from camp.common.errors import ConfigError
from camp.common.paths import policies_root

CONFIG = "config.yaml"  # the resolved configuration
VERSIONS = "versions.json"  # code, packages, machine and command
METRICS = "metrics.jsonl"  # one line for each iteration
IMITATION = "imitation.jsonl"  # one line for each epoch of the warm start
CHECKPOINTS = "checkpoints"  # folder of checkpoint_<iteration>.pt
WANDB_ID = "wandb_id.txt"  # by which a continued run finds its W&B run
WANDB = "wandb"  # folder of the W&B run; the same name beside the run folders lists those of all runs
REPORT = "eval.json"  # what the evaluation says
ARRAYS = "eval.npz"  # what it recorded
VIDEOS = "videos"
DIVERGED = "diverged"  # folder of what `camp.replay` shows
FIGURES = "figures"
MODEL = "policy.onnx"
METADATA = "policy.json"
CARD = "README.md"  # of a shipped policy
LATEST = "latest"  # beside the run folders: a link to the newest


def versions_after(iteration: int) -> str:
    """The file of the versions that a run was continued with after ``iteration``."""
    return f"{Path(VERSIONS).stem}-{iteration:08d}.json"


def resumed_at(run: Path) -> list[int]:
    """The iterations after which a run was continued, in order."""
    stem = Path(VERSIONS).stem
    return [int(found.stem.removeprefix(f"{stem}-")) for found in sorted(run.glob(f"{stem}-*.json"))]


def check_root(root: Path) -> None:
    """Raise ConfigError where `new_run_folder` could not make a run folder; leaves nothing behind.

    Long work comes before the folder is made, and must not be lost by its place.
    """
    existing = next(place for place in (root, *root.absolute().parents) if place.exists())
    try:
        with tempfile.TemporaryFile(dir=existing):
            pass
    except OSError as error:
        raise ConfigError(f"output folder {root}: {error.strerror or error}; choose one that can be written") from error
    latest = root / LATEST
    if latest.exists() and not latest.is_symlink():
        raise ConfigError(f"output folder {root}: its {LATEST} is no link but a file or folder; move that away")


def new_run_folder(root: Path, name: str) -> Path:
    """Create `<root>/<date>-<time>-<name>`, numbered when that exists, and let `<root>/latest` point to it.

    Call it after everything has been validated: a command that fails early then leaves nothing behind.
    Raises ConfigError when `root` cannot be written.
    """
    stem = f"{datetime.now():%Y%m%d-%H%M%S}-{name}"
    try:
        root.mkdir(parents=True, exist_ok=True)
        for attempt in range(1, 1000):
            folder = root / (stem if attempt == 1 else f"{stem}-{attempt}")
            with contextlib.suppress(FileExistsError):
                folder.mkdir()  # creates or fails in one step, so that two jobs never share a folder
                _point(root / LATEST, folder)
                return folder
    except OSError as error:
        raise ConfigError(f"output folder {root}: {error.strerror or error}; choose one that can be written") from error
    raise ConfigError(f"output folder {root}: already holds 999 runs {stem}; choose another name")


def _point(link: Path, folder: Path) -> None:
    """Make `link` a symbolic link to its sibling `folder`, in one step for whoever reads it meanwhile."""
    fresh = link.with_name(f".{link.name}-{folder.name}")
    fresh.symlink_to(folder.name, target_is_directory=True)
    fresh.replace(link)


def results_folder(run: Path) -> Path:
    """Where files made from a run go: its own folder; for a shipped policy, which stays as it is, outputs/<name>/."""
    if run.resolve().is_relative_to(policies_root().resolve()):
        return Path("outputs") / run.resolve().name
    return run
