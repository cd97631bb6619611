"""Evaluate a run: ``python -m camp.evaluate run=<run folder>``; see conf/evaluation/evaluate.yaml."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import torch
from omegaconf import DictConfig
from rich.console import Console

from camp.build import Run, build_actor, load_run
from camp.cli.hydra_main import run_hydra
from camp.common.errors import ConfigError
from camp.common.files import make_folder, whole_file, write_text
from camp.common.seeding import generator
from camp.evaluation.config import EvaluationConfig, resolve_evaluation
from camp.evaluation.films import film
from camp.evaluation.judge import Judge, Judgement
from camp.evaluation.record import log_evaluation
from camp.evaluation.rollout import Policy
from camp.evaluation.tables import printed
from camp.robots import go2
from camp.runs.folder import ARRAYS, REPORT, VIDEOS, results_folder

TABLE_WIDTH = 140  # characters, where the output is not a terminal


def evaluate(composed: DictConfig) -> Path:
    """Judge the run's policy, beside two that do not walk; print tables, write eval.json, eval.npz and videos."""
    evaluation = resolve_evaluation(composed)
    run = load_run(Path(evaluation.run))
    folder = make_folder(results_folder(Path(evaluation.run)))
    if evaluation.video:
        make_folder(folder / VIDEOS)
    baselines = _baselines(run) if evaluation.baselines else {}
    judgement = Judge(run.config, evaluation, run.clips).judge(run.actor, baselines)
    report = _heading(run, folder, evaluation) | judgement.report
    _write(folder, report, judgement)
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(printed(report))
    print(f"wrote {folder / REPORT} and {folder / ARRAYS}", flush=True)
    videos = film(judgement, run.skills, evaluation, folder / VIDEOS) if evaluation.video else {}
    log_evaluation(run, folder, report, videos)
    return folder


def _baselines(run: Run) -> dict[str, Policy]:
    return {
        "untrained": build_actor(run.config, generator(run.config.seed, "weights")),
        "standing": lambda observation: torch.zeros(len(observation), go2.NUM_JOINTS),
    }


def _heading(run: Run, folder: Path, evaluation: EvaluationConfig) -> dict:
    return {
        "run": folder.resolve().name,
        "variant": run.config.variant,
        "iteration": run.iteration,
        "seed": run.config.seed,
        "parts": list(evaluation.parts),
        "duration_s": evaluation.duration_s,
        "discard_s": evaluation.discard_s,
    }


def _write(folder: Path, report: dict, judgement: Judgement) -> None:
    write_text(folder / REPORT, json.dumps(report, indent=2, allow_nan=False) + "\n")
    arrays = folder / ARRAYS
    try:
        with whole_file(arrays) as file:
            np.savez_compressed(file, allow_pickle=False, **judgement.arrays)  # pyright: ignore[reportArgumentType]
    except OSError as error:
        raise ConfigError(f"file {arrays}: {error.strerror or error}; free some space") from error


if __name__ == "__main__":
    sys.exit(run_hydra("evaluation/evaluate", evaluate))
