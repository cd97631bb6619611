"""The record of a run: metrics, configuration, versions and a Weights & Biases run."""

from __future__ import annotations

import contextlib
import errno
import json
import os
from collections.abc import Callable, Mapping

from omegaconf import DictConfig, OmegaConf

from camp.common.commands import command
from camp.common.errors import ConfigError
from camp.common.files import write_text
from camp.runs.config import LoggerConfig
from camp.runs.folder import CONFIG, METRICS, VERSIONS, versions_after
from camp.runs.metrics import Metric, metrics_line, truncate_metrics
from camp.runs.versions import collect_versions
from camp.runs.wandb_run import RunIdentity, for_wandb, how_to_look, start_wandb


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
        self.folder = identity.folder
        metrics_path = self.folder / METRICS
        versions_name = VERSIONS
        if resume_from is not None:
            truncate_metrics(metrics_path, resume_from)
            versions_name = versions_after(resume_from)
        write_text(self.folder / CONFIG, OmegaConf.to_yaml(config, resolve=True))
        write_text(self.folder / versions_name, json.dumps(collect_versions(), indent=2) + "\n")
        self._wandb = None
        if logger.wandb_mode != "disabled":
            self._wandb = start_wandb(identity, logger, config)
            announce(how_to_look(self.folder, logger.wandb_mode))
        # Without a buffer, so that closing after a failed write has nothing left to write.
        self._file = metrics_path.open("ab", buffering=0)

    def log(self, iteration: int, metrics: Mapping[str, Metric]) -> None:
        """Append one line for `iteration`; keys are paths such as reward/style/raw.

        Raises ConfigError where it cannot be written; the lines before stay whole.
        """
        path, whole = self.folder / METRICS, self._file.tell()
        line = metrics_line(iteration, metrics).encode()
        try:
            written = self._file.write(line)
            if written != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):
                self._file.truncate(whole)
            raise ConfigError(
                f"metrics {path}: {error.strerror or error}; free some space, then continue with "
                f"{command('camp.train', resume=self.folder)}"
            ) from error
        if self._wandb is not None:
            self._wandb.log({key: for_wandb(value) for key, value in metrics.items()}, step=iteration)

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
