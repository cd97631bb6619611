"""What the figures read, made up: features of a good skill discriminator, an evaluation's arrays, and metrics."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from analysis.load import ClipFeatures
from camp.gaits.schedule import GAIT_PHASES

PERIOD = 0.02  # s
COMMANDS = ((0.5, 0.0, 0.0), (0.0, 0.3, 0.0))  # vx, vy, wz


def clip_features(generator: np.random.Generator, size: int = 8) -> list[ClipFeatures]:
    """Four gaits x 2 and 4 Hz x two commands: features (199, size), gaits 14 apart, rhythm of amplitude 1."""
    clips = []
    for index, gait in enumerate(GAIT_PHASES):
        for frequency in (2.0, 4.0):
            for command in COMMANDS:
                angle = 2 * np.pi * frequency * PERIOD * np.arange(199)
                feature = generator.normal(scale=0.1, size=(199, size))
                feature[:, index] += 10.0
                feature[:, -1] += np.sin(angle)
                clips.append(ClipFeatures(gait, frequency, np.array(command), feature, 5, PERIOD))
    return clips


def write_evaluation(folder: Path, **changes) -> Path:
    """eval.npz as the evaluation writes it, as far as the figures read it; T = 100."""
    arrays = {
        "period": np.float64(0.02),
        "skills": np.array(["trot", "pace"]),
        "skill_switch_contact": np.arange(400).reshape(100, 4) % 3 == 0,
        "skill_switch_skill": np.repeat([0, 1], 50),
    }
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(folder / "eval.npz", **{key: value for key, value in (arrays | changes).items() if value is not None})
    return folder


def metrics(iterations: int, skills: tuple[str, ...] = ("trot_2hz", "trot_3hz", "pace_2hz", "pace_3hz")) -> list[dict]:
    """Rows of 10,000 steps an iteration, as training writes them, as far as the figures read them; every fifth one
    has readings of gaits and of logits, which are all between 0.25 and 0.5 for the policy."""
    rows = []
    for iteration in range(1, iterations + 1):
        row: dict[str, Any] = {
            "iteration": iteration,
            "steps": 1e4 * iteration,
            "reward/task/raw": 1.0,
            "reward/style/raw": 0.5,
            "reward/skill/raw": 0.25,
            "tracking/linear_error_fast": 0.3,
            "tracking/yaw_rate_error": 0.2,
            "env/falls_per_1000_steps": float(iteration % 2),
            "prior/style/accuracy": 0.8,
            "prior/style/expert_logit": 0.6,
            "prior/style/policy_logit": 0.4,
            "prior/skill/policy_accuracy": 0.7,
            "ppo/kl": None if iteration == 1 else 0.01,
            "ppo/learning_rate": 1e-5 * min(iteration**2, 100),
        }
        if iteration % 5 == 0:
            row |= {f"gait/{skill}/accuracy": 0.9 for skill in skills}
            row["prior/style/logit_histogram/policy"] = [float(bin_ == 13) for bin_ in range(24)]
        rows.append(row)
    return rows


def write_metrics(folder: Path, rows: list[dict]) -> Path:
    """metrics.jsonl in a run folder."""
    (folder / "metrics.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    return folder
