"""What every judging command has: expert motions, printed tables and result files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from camp.build import Run
from camp.common.commands import command
from camp.common.errors import ConfigError
from camp.common.files import whole_pair
from camp.common.paths import shipped_motions
from camp.common.progress import phase
from camp.evaluation.cells import table_console
from camp.evaluation.evaluator import Judgement
from camp.evaluation.report import Report, as_json
from camp.evaluation.tables import printed
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clips
from camp.robots.registry import find_robot
from camp.robots.robot import Robot
from camp.runs.folder import ARRAYS, REPORT


def expert_motions(robot: Robot, folder: Path | None = None) -> list[Clip]:
    """The clips that every policy of the robot is judged beside: the shipped ones, or those of a folder.

    Raises ClipError.
    """
    with phase("reading the expert's clips"):
        return load_clips(robot, folder or shipped_motions(robot.name), tuple(GAIT_PHASES))


def motions_beside(run: Run) -> list[Clip]:
    """The clips that a run's policy is judged beside: those of its own folder where none of its robot are shipped.

    Raises ClipError.
    """
    robot, own = find_robot(run.config.robot.name), run.config.motion.folder
    shipped = any(shipped_motions(robot.name).glob("*.npz"))
    return expert_motions(robot, None if shipped or own is None else Path(own))


def print_report(report: Report, path: Path, everything: bool = False) -> None:
    """The verdict and the tables that it is about, and how to see the others of the report in ``path``."""
    console = table_console()
    console.print(printed(report, console.width, everything))
    if not everything:
        print(f"all tables: {command('camp.judge', report=path)}", flush=True)


def write_judgement(folder: Path, judgement: Judgement) -> None:
    """Write eval.json and eval.npz, which belong together. Raises ConfigError where the folder cannot be written."""
    path = folder / ARRAYS
    try:
        with whole_pair(path, folder / REPORT) as (arrays, report):
            report.write(as_json(judgement.report).encode())
            np.savez_compressed(arrays, allow_pickle=False, **judgement.arrays)  # pyright: ignore[reportArgumentType]
    except OSError as error:
        raise ConfigError(f"file {path}: {error.strerror or error}; free some space") from error
