"""The record of a run: metrics.jsonl, config.yaml, versions.json and a Weights & Biases run.

metrics.jsonl holds one JSON object per iteration, {"iteration": 12, "reward/style/raw": 0.4, ...}; a value
that is not finite is written as null, which strict JSON readers accept. A histogram is a list of its shares.
"""

from __future__ import annotations

import json
import math
import os
import secrets
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from omegaconf import MISSING, DictConfig, OmegaConf

from camp.errors import CheckpointError, ConfigError
from camp.files import write_text
from camp.histogram import EDGES
from camp.versions import collect_versions

METRICS = "metrics.jsonl"
WANDB_MODES = ("offline", "online", "disabled")

Metric = float | list[float]  # a list: a histogram's shares, in the bins of camp.histogram


@dataclass
class LoggerConfig:
    """Where metrics go besides the run folder."""

    wandb_mode: str = MISSING  # offline: files only, no network; online: uploaded at once; disabled: no W&B
    wandb_project: str = MISSING
    wandb_tags: list[str] = MISSING  # besides the ones the run gives itself

    def check(self) -> None:
        """Raise ConfigError for a value that cannot work."""
        if self.wandb_mode not in WANDB_MODES:
            modes = ", ".join(WANDB_MODES)
            raise ConfigError(f"logger.wandb_mode {self.wandb_mode!r}: choose one of {modes}")
        if not self.wandb_project or set(self.wandb_project) & set("/\\#?%:"):
            raise ConfigError(f"logger.wandb_project {self.wandb_project!r}: write a name without any of / \\ # ? % :")


@dataclass
class RunIdentity:
    """How a run is found among others."""

    folder: Path  # the run folder, which exists
    group: str  # the variant: what runs differing in their seed alone have in common
    tags: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        return self.folder.resolve().name  # of the run itself, where outputs/latest was given


class RunLogger:
    """Writes a run's record; one process may have several of them one after the other.

    Use it as a context manager, or call `finish` in a `finally`: the next run of a sweep starts only after
    the W&B run of this one has ended.
    """

    def __init__(
        self,
        identity: RunIdentity,
        logger: LoggerConfig,
        config: DictConfig,
        resume_from: int | None = None,
        announce: Callable[[str], None] = print,
    ) -> None:
        """Start the record of a run or, after `resume_from` iterations, go on with it.

        `config` is the whole configuration of the run. Continuing cuts the metrics behind that iteration and
        writes versions-<iteration>.json beside the first one. `announce` gets the
        lines that say how to look at the W&B run. Raises ConfigError, CheckpointError.
        """
        logger.check()
        self.folder = identity.folder
        metrics_path = self.folder / METRICS
        versions_name = "versions.json"
        if resume_from is not None:
            truncate_metrics(metrics_path, resume_from)
            versions_name = f"versions-{resume_from:08d}.json"
        write_text(self.folder / "config.yaml", OmegaConf.to_yaml(config, resolve=True))
        write_text(self.folder / versions_name, json.dumps(collect_versions(), indent=2) + "\n")
        self._wandb = None
        if logger.wandb_mode != "disabled":
            self._wandb = start_wandb(identity, logger, config)
            announce(_how_to_look(self.folder, logger.wandb_mode))
        self._file = metrics_path.open("a", encoding="utf-8")

    def log(self, iteration: int, metrics: Mapping[str, Metric]) -> None:
        """Append one line for `iteration`; keys are paths such as reward/style/raw."""
        line = {"iteration": iteration} | {key: _for_json(value) for key, value in metrics.items()}
        # One write and one flush: a process killed at any moment leaves whole lines, but for the last one.
        self._file.write(json.dumps(line) + "\n")
        self._file.flush()
        if self._wandb is not None:
            self._wandb.log({key: _for_wandb(value) for key, value in metrics.items()}, step=iteration)

    def finish(self, exit_code: int = 0) -> None:
        """Close the files and end the W&B run; a second call does nothing."""
        self._file.close()
        if self._wandb is not None:
            self._wandb.finish(exit_code=exit_code)
            self._wandb = None

    def __enter__(self) -> RunLogger:
        return self

    def __exit__(self, error_type: type[BaseException] | None, *_: object) -> None:
        self.finish(exit_code=0 if error_type is None else 1)


class NoLogger:
    """The record that the ranks after the first do not keep."""

    def log(self, iteration: int, metrics: Mapping[str, Metric]) -> None:
        """Nothing."""

    def __enter__(self) -> NoLogger:
        return self

    def __exit__(self, *_: object) -> None: ...


def _for_json(value: Metric) -> Metric | None:
    if isinstance(value, list):
        return value
    return float(value) if math.isfinite(value) else None


def _for_wandb(value: Metric) -> Any:
    if not isinstance(value, list):
        return float(value)
    import wandb  # there already, where a W&B run is

    return wandb.Histogram(np_histogram=(np.array(value), np.array(EDGES)))


def read_metrics(path: Path) -> list[dict[str, Any]]:
    """The lines of a metrics.jsonl; a last line torn by a kill is left out. Raises CheckpointError."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    except (OSError, UnicodeDecodeError) as error:
        raise CheckpointError(f"metrics {path}: unreadable ({error}); name a complete run folder") from error
    rows = []
    for number, line in enumerate(lines, start=1):
        try:
            row = json.loads(line)
            rows.append(row | {"iteration": int(row["iteration"])})
        except (ValueError, TypeError, KeyError) as error:
            if number == len(lines) and not line.endswith("\n"):
                break
            raise CheckpointError(
                f"metrics {path} line {number}: not a metrics line; restore the file or remove that line"
            ) from error
    return rows


def truncate_metrics(path: Path, last_iteration: int) -> None:
    """Drop the lines behind `last_iteration`, which a resumed run writes again. Raises CheckpointError."""
    kept = [row for row in read_metrics(path) if row["iteration"] <= last_iteration]
    write_text(path, "".join(json.dumps(row) + "\n" for row in kept))


def start_wandb(identity: RunIdentity, logger: LoggerConfig, config: DictConfig) -> Any:
    """Begin the folder's W&B run, or go on with it where its wandb_id.txt says which. Raises ConfigError."""
    import wandb  # takes a second to import, which a run without it need not wait for
    from wandb.errors import Error as WandbError

    mode = logger.wandb_mode
    id_file = identity.folder / "wandb_id.txt"
    resumed = id_file.is_file()
    if not resumed:
        write_text(id_file, secrets.token_hex(4) + "\n")
    try:
        run = wandb.init(
            mode="online" if mode == "online" else "offline",
            dir=str(identity.folder.resolve()),  # the W&B service keeps the working directory it began in
            project=logger.wandb_project,
            id=id_file.read_text(encoding="utf-8").strip(),
            # Offline there is no server to resume from: a second local run of the same id is begun, and
            # `wandb sync` joins the two, in order of time.
            resume="allow" if mode == "online" and resumed else None,
            name=identity.name,
            group=identity.group,
            tags=[*identity.tags, *logger.wandb_tags],
            config=OmegaConf.to_container(config, resolve=True),  # type: ignore[arg-type]
            settings=wandb.Settings(silent=True, console="off", quiet=True),
        )
    except WandbError as error:
        raise ConfigError(
            f"logger.wandb_mode {mode!r}: W&B did not start ({' '.join(str(error).split())}); "
            "run `wandb login`, or use logger.wandb_mode=offline"
        ) from error
    _list_beside_others(Path(run.dir).parent, identity.folder.parent / "wandb")
    return run


def _list_beside_others(wandb_run: Path, index: Path) -> None:
    """Link the W&B run in the folder that `wandb leet` opens, to see the runs of a sweep side by side."""
    try:
        index.mkdir(exist_ok=True)
        (index / wandb_run.name).symlink_to(os.path.relpath(wandb_run, index), target_is_directory=True)
    except OSError:  # a file system without links: the runs can still be opened one by one
        return


def _how_to_look(folder: Path, mode: str) -> str:
    all_runs = shlex.quote(os.path.relpath(folder.parent / "wandb"))
    this_run = shlex.quote(os.path.relpath(folder / "wandb"))
    line = f"W&B ({mode}): browse all runs without a network: wandb leet {all_runs}"
    return line if mode == "online" else f"{line} ; upload this one: wandb sync {this_run}/offline-run-*"
