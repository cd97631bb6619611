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
from camp.cli import run_hydra
from camp.errors import CampError
from camp.evaluation.config import EvaluationConfig, resolve_evaluation
from camp.evaluation.report import arrays, summarize, summarize_switching, table
from camp.evaluation.rollout import Policy, Recording, roll_out
from camp.logger import write_text
from camp.rendering import RobotRenderer, write_video
from camp.robots import go2
from camp.seeding import generator

TABLE_WIDTH = 120  # characters, where the output is not a terminal
STEPS_PER_FRAME = 2  # 25 frames per second


def evaluate(composed: DictConfig) -> Path:
    """Roll out the run's policy beside two that do not walk; write eval.json, eval.npz and videos."""
    evaluation = resolve_evaluation(composed)
    folder = Path(evaluation.run)
    run = load_run(folder)
    untrained = build_actor(run.config, generator(run.config.seed, "weights"))
    policies: dict[str, Policy] = {
        "trained": run.actor,
        "untrained": untrained,
        "standing": lambda observation: torch.zeros(len(observation), go2.NUM_JOINTS),
    }
    recordings = {name: roll_out(policy, run.config, evaluation, run.clips) for name, policy in policies.items()}
    recording, skills = recordings["trained"], run.config.motion.skill_set()
    summaries = {name: summarize(one, skills, evaluation.discard_s) for name, one in recordings.items()}
    report = {
        "run": folder.name,
        "iteration": run.iteration,
        "seed": run.config.seed,
        "duration_s": evaluation.duration_s,
        "discard_s": evaluation.discard_s,
        "policies": summaries,
        "switching": summarize_switching(recording, skills),
    }
    write_text(folder / "eval.json", json.dumps(report, indent=2) + "\n")
    _write_arrays(folder / "eval.npz", arrays(recording, skills, evaluation.commands))
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(table(summaries))
    print(f"wrote {folder / 'eval.json'} and {folder / 'eval.npz'}", flush=True)
    if evaluation.video:
        _film(run, recording, evaluation, folder / "videos")
    return folder


def _film(run: Run, recording: Recording, evaluation: EvaluationConfig, folder: Path) -> None:
    """An mp4 of each skill and of the switching sequence; without OpenGL a line that says so."""
    try:
        renderer = RobotRenderer(go2.load_model())
    except CampError as error:
        print(f"no videos: {error}", file=sys.stderr)
        return
    folder.mkdir(exist_ok=True)
    steps = round(evaluation.video_s / recording.period_s)
    rows = {name: k * len(evaluation.commands) + evaluation.video_command for k, name in enumerate(run.skills)}
    films = {name: recording.qpos[row, :steps] for name, row in rows.items()} | {"switching": recording.qpos[-1]}
    for name, film in films.items():
        frames = map(renderer.frame, film[::STEPS_PER_FRAME])
        write_video(folder / f"{name}.mp4", frames, 1.0 / (STEPS_PER_FRAME * recording.period_s))
        print(f"wrote {folder / f'{name}.mp4'}", flush=True)
    renderer.close()


def _write_arrays(path: Path, values: dict[str, np.ndarray]) -> None:
    partial = path.with_name(f"{path.name}.partial.npz")
    np.savez_compressed(partial, allow_pickle=False, **values)  # pyright: ignore[reportArgumentType]
    partial.replace(path)


if __name__ == "__main__":
    sys.exit(run_hydra("evaluation/evaluate", evaluate))
