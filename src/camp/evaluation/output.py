"""What every judging command has: expert motions, printed tables and result files."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from rich.console import Console

from camp.common.errors import ConfigError
from camp.common.files import whole_pair
from camp.common.paths import shipped_motions
from camp.common.progress import phase
from camp.evaluation.evaluator import Judgement
from camp.evaluation.report import Report, as_json
from camp.evaluation.robot import ROBOT
from camp.evaluation.tables import printed
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clips
from camp.runs.folder import ARRAYS, REPORT

TABLE_WIDTH = 150  # characters, where the output is not a terminal


def expert_motions() -> list[Clip]:
    """The shipped clips, which every policy is judged beside. Raises ClipError."""
    with phase("reading the expert's clips"):
        return load_clips(ROBOT, shipped_motions(ROBOT.name), tuple(GAIT_PHASES))


def print_report(report: Report) -> None:
    """All tables."""
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(printed(report))


def write_judgement(folder: Path, judgement: Judgement) -> None:
    """Write eval.json and eval.npz, which belong together. Raises ConfigError where the folder cannot be written."""
    path = folder / ARRAYS
    try:
        with whole_pair(path, folder / REPORT) as (arrays, report):
            report.write(as_json(judgement.report).encode())
            np.savez_compressed(arrays, allow_pickle=False, **judgement.arrays)  # pyright: ignore[reportArgumentType]
    except OSError as error:
        raise ConfigError(f"file {path}: {error.strerror or error}; free some space") from error
