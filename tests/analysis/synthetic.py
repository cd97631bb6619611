"""What the figures read, made up: features of a good skill discriminator, and an evaluation's arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from analysis.load import ClipFeatures
from camp.motion.gaits import GAIT_PHASES

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
