"""The Weights & Biases run of a run folder."""

from __future__ import annotations

import os
import re
import secrets
import shlex
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from omegaconf import DictConfig, OmegaConf

from camp.common.errors import ConfigError
from camp.common.files import write_text
from camp.common.histogram import EDGES
from camp.runs.config import LoggerConfig
from camp.runs.folder import WANDB, WANDB_ID
from camp.runs.metrics import Metric


@dataclass
class RunIdentity:
    """How a run is found among others."""

    folder: Path  # the run folder, which exists
    group: str  # the variant: what runs differing in their seed alone have in common
    tags: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Variant and seed: the run folder's own name, also where outputs/latest was given, without its date."""
        return re.sub(r"^\d{8}-\d{6}-", "", self.folder.resolve().name)


def start_wandb(identity: RunIdentity, logger: LoggerConfig, config: DictConfig) -> Any:
    """Begin the folder's W&B run, or go on with it where one was begun. Raises ConfigError."""
    import wandb  # takes a second to import, which a run without it need not wait for
    from wandb.errors import Error as WandbError

    mode = logger.wandb_mode
    id_file = identity.folder / WANDB_ID
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
    _list_beside_others(Path(run.dir).parent, identity.folder.parent / WANDB)
    return run


def _list_beside_others(wandb_run: Path, index: Path) -> None:
    """Link the W&B run in the folder that `wandb leet` opens, to see the runs of a sweep side by side."""
    try:
        index.mkdir(exist_ok=True)
        (index / wandb_run.name).symlink_to(os.path.relpath(wandb_run, index), target_is_directory=True)
    except OSError:  # a file system without links: the runs can still be opened one by one
        return


def how_to_look(folder: Path, mode: str) -> str:
    all_runs = shlex.quote(os.path.relpath(folder.parent / WANDB))
    this_run = shlex.quote(os.path.relpath(folder / WANDB))
    line = f"W&B ({mode}): browse all runs without a network: wandb leet {all_runs}"
    return line if mode == "online" else f"{line} ; upload this one: wandb sync {this_run}/offline-run-*"


def for_wandb(value: Metric) -> Any:
    if not isinstance(value, list):
        return float(value)
    import wandb  # there already, where a W&B run is

    return wandb.Histogram(np_histogram=(np.array(value), np.array(EDGES)))
