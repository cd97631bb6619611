"""What every judging command fractions: expert motions, progress, printed tables and result files."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from camp.common.errors import ConfigError
from camp.common.files import whole_file
from camp.common.paths import shipped_motions
from camp.evaluation.evaluator import Judgement
from camp.evaluation.report import Report, write_report
from camp.evaluation.robot import ROBOT
from camp.evaluation.rollout import Progress as Steps
from camp.evaluation.tables import printed
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clips
from camp.runs.folder import ARRAYS, REPORT

TABLE_WIDTH = 150  # characters, where the output is not a terminal
LINES = 5  # of progress, where the output is not a terminal


def expert_motions() -> list[Clip]:
    """The shipped clips, which every policy is judged beside. Raises ClipError."""
    return load_clips(ROBOT, shipped_motions(ROBOT.name), tuple(GAIT_PHASES))


def step_counter() -> Steps:
    """Shows how far a roll-out is: a bar on a terminal, some lines elsewhere."""
    if not sys.stdout.isatty():

        def line(done: int, total: int) -> None:
            if done * LINES % total < LINES:
                print(f"walking: {done} of {total} control steps", flush=True)

        return line
    columns = (TextColumn("walking"), BarColumn(), TextColumn("{task.completed} of {task.total}"))
    bar = Progress(*columns, TimeRemainingColumn(), transient=True)
    task = bar.add_task("walking")

    def renew(done: int, total: int) -> None:
        if done == 1:
            bar.start()
        bar.update(task, completed=done, total=total)
        if done == total:
            bar.stop()

    return renew


def print_report(report: Report) -> None:
    """All tables."""
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(printed(report))


def write_judgement(folder: Path, judgement: Judgement) -> None:
    """Write eval.json and eval.npz. Raises ConfigError where the folder cannot be written."""
    write_report(folder / REPORT, judgement.report)
    path = folder / ARRAYS
    try:
        with whole_file(path) as file:
            np.savez_compressed(file, allow_pickle=False, **judgement.arrays)  # pyright: ignore[reportArgumentType]
    except OSError as error:
        raise ConfigError(f"file {path}: {error.strerror or error}; free some space") from error
