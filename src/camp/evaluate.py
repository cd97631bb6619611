"""Evaluate a run: ``python -m camp.evaluate run=<run folder>``; see conf/evaluation/evaluate.yaml."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from omegaconf import DictConfig

from camp.build import load_run
from camp.cli.hydra_main import run_hydra
from camp.common.commands import command
from camp.common.files import make_folder
from camp.common.progress import track
from camp.evaluation.config import resolve_evaluation
from camp.evaluation.evaluator import Evaluator
from camp.evaluation.films import film
from camp.evaluation.output import motions_beside, print_report, write_judgement
from camp.evaluation.record import log_evaluation
from camp.evaluation.subjects import subject_of_run
from camp.robots.registry import find_robot
from camp.runs.folder import ARRAYS, REPORT, VIDEOS, results_folder


def evaluate(composed: DictConfig) -> Path:
    """Judge the run's policy, beside three that do not walk; print tables, write eval.json, eval.npz and videos."""
    evaluation = resolve_evaluation(composed)
    run = load_run(Path(evaluation.run))
    folder = make_folder(results_folder(Path(evaluation.run)))
    if evaluation.video:
        make_folder(folder / VIDEOS)
    subject = subject_of_run(run, Path(evaluation.run), folder.resolve().name, evaluation.baselines)
    robot = find_robot(run.config.robot.name)
    judgement = Evaluator(evaluation, motions_beside(run), track).judge(subject)
    write_judgement(folder, judgement)
    print_report(judgement.report, folder / REPORT)
    print(f"wrote {folder / REPORT} and {folder / ARRAYS}", flush=True)
    videos = film(robot, judgement, run.skills, evaluation, folder / VIDEOS) if evaluation.video else {}
    log_evaluation(run, folder, judgement.report, videos)
    return folder


def compare(folders: Sequence[Path]) -> None:
    """Say how the runs of a sweep are put side by side."""
    if len(folders) > 1:
        print(f"compare these {len(folders)} runs: {command('analysis.seeds', *map(str, folders))}", flush=True)


if __name__ == "__main__":
    sys.exit(run_hydra("evaluation/evaluate", evaluate, after_sweep=compare))
