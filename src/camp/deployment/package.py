"""A finished run as a small run folder to ship."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf

from camp.build import load_run, motion_folder
from camp.common.archive import read_arrays
from camp.common.commands import command
from camp.common.errors import CheckpointError, ConfigError
from camp.common.files import write_text
from camp.common.foreign import foreign_file, read_json
from camp.common.paths import shipped_motions
from camp.config.resolve import as_yaml, load_run_config
from camp.config.schema import Config
from camp.deployment.export import metadata
from camp.deployment.provenance import condensed, describe, provenance, rounded
from camp.evaluation.report import Report, read_report
from camp.runs.checkpoint import save_run_checkpoint
from camp.runs.folder import ARRAYS, CARD, CONFIG, IMITATION, METADATA, METRICS, REPORT, VERSIONS
from camp.runs.metrics import read_metrics
from camp.runs.state import load_state

EVALUATION_FILES = (REPORT, ARRAYS)
JUDGED = ("policies", "table_i", "switching", "verdict")  # in the report: what the targets are about, and the verdict


def ship_policy(run: Path, folder: Path, minutes: float | None = None) -> Path:
    """Write the latest policy of a run folder as the small run folder ``folder``, and return it.

    minutes: wall-clock time of the whole training command, where it was measured. Raises CampError, before anything
    is written, where ``folder`` is there already, the run is damaged, has not been evaluated as a whole at its latest
    checkpoint, was trained on clips that are not shipped, or is a shipped policy itself.
    """
    if folder.exists():
        raise ConfigError(f"policy {folder}: is there already; delete it first, or choose another name")
    loaded, state = load_run(run), load_state(run)
    if state.is_shipped:
        raise ConfigError(f"run folder {run}: is a shipped policy already; copy the folder, or ship the run it is from")
    report = _evaluation(run, loaded.iteration)
    config = _portable(load_run_config(run))
    made_by = provenance(run, loaded.iteration, config, minutes)
    rows, epochs = condensed(read_metrics(run / METRICS)), _epochs(run / IMITATION)
    partial = folder.with_name(f".{folder.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    try:
        partial.mkdir(parents=True)
        save_run_checkpoint(partial, loaded.iteration, state.shipped().as_dict(), keep=1)
        write_text(partial / CONFIG, OmegaConf.to_yaml(as_yaml(config), resolve=True))
        write_text(partial / METADATA, json.dumps(metadata(config), indent=2) + "\n")
        write_text(partial / VERSIONS, json.dumps(made_by.versions, indent=2) + "\n")
        write_text(partial / METRICS, _lines(rows))
        write_text(partial / CARD, describe(folder.name, made_by, report))
        if epochs is not None:
            write_text(partial / IMITATION, _lines(epochs))
        for name in EVALUATION_FILES:
            shutil.copyfile(run / name, partial / name)
        load_run(partial)
        partial.rename(folder)
    except OSError as error:
        raise ConfigError(f"policy {folder}: {error.strerror or error}; choose a folder that can be written") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return folder


def _evaluation(run: Path, iteration: int) -> Report:
    """The whole evaluation of exactly this policy. Raises CampError where there is none."""
    remedy = f"run `{command('camp.evaluate', run=run)}` first"
    for name in EVALUATION_FILES:
        if not (run / name).is_file():
            raise ConfigError(f"run folder {run}: holds no {name}; {remedy}")
    report = read_report(run / REPORT, remedy)
    if report.iteration != iteration:
        raise ConfigError(
            f"run folder {run}: {REPORT} is of iteration {report.iteration}, its policy of {iteration}; {remedy}"
        )
    lacking = [key for key in JUDGED if not getattr(report, key)]
    if lacking:
        raise ConfigError(f"run folder {run}: {REPORT} is of a partial evaluation, without {lacking[0]}; {remedy}")
    with foreign_file(run / ARRAYS, f"run folder {run}: {ARRAYS} is damaged", remedy, ConfigError):
        read_arrays(run / ARRAYS)
    return report


def _epochs(path: Path) -> list[dict[str, Any]] | None:
    """The learning curve of the imitation; None for a run without. Raises CheckpointError where it is damaged."""
    if not path.is_file():
        return None
    remedy = "restore the file, or delete it to ship without"
    with foreign_file(path, f"file {path}: no learning curve", remedy, CheckpointError):
        return [rounded(read_json(line)) for line in path.read_text(encoding="utf-8").splitlines()]


def _portable(config: Config) -> Config:
    """The configuration without places of the machine that trained."""
    shipped = shipped_motions(config.robot.name)
    if motion_folder(config).resolve() != shipped.resolve():
        raise ConfigError(
            f"motion.folder = {config.motion.folder!r}: a shipped policy is judged against the shipped clips; train "
            "on those (motion.folder=null)"
        )
    config.motion.folder = config.motion.perturbed_folder = config.resume = None
    config.output_dir = "outputs"
    return config


def _lines(rows: Sequence[dict[str, Any]]) -> str:
    return "".join(json.dumps(row) + "\n" for row in rows)
