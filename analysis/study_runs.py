"""The runs of a study on the disk: what is there, what goes on, and what is done."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.study import Job, Study
from camp.cli.hydra_main import EXIT_INTERRUPTED
from camp.common.errors import CampError
from camp.common.files import make_folder, write_text
from camp.runs.checkpoint import list_checkpoints
from camp.runs.folder import REPORT

SECONDS = "study_seconds.txt"  # in a run folder: wall-clock s of each stretch of training and evaluation, one a line


class StudyError(CampError):
    """A run of a study did not end well."""


@dataclass(frozen=True)
class State:
    """How far a job is. folder: None before its first checkpoint; iteration: of the latest one."""

    folder: Path | None
    iteration: int
    evaluated: bool

    def done(self, study: Study) -> bool:
        """Whether it is trained to its end and evaluated."""
        return self.iteration >= study.iterations and self.evaluated


def runs_folder(study: Study, root: Path) -> Path:
    """Where a study's runs lie: one folder for each version of its YAML, so that no result mixes two."""
    return root / f"{study.name}-{study.digest}"


def state_of(job: Job, runs: Path) -> State:
    """The newest run folder of the job that holds a checkpoint."""
    pattern = re.compile(rf"\d{{8}}-\d{{6}}-{job.arm}-seed{job.seed}(-\d+)?")
    folders = sorted(path for path in runs.glob("*") if pattern.fullmatch(path.name) and list_checkpoints(path))
    if not folders:
        return State(None, 0, evaluated=False)
    checkpoint = list_checkpoints(folders[-1])[-1]
    iteration = int(checkpoint.stem.rpartition("_")[2])
    return State(folders[-1], iteration, (folders[-1] / REPORT).is_file())


def carry_out(job: Job, study: Study, runs: Path) -> None:
    """Train, or continue what was cut off, then evaluate; nothing where all is done. Raises StudyError.

    Each command is a process of its own, as it would be typed.
    """
    state = state_of(job, runs)
    if state.done(study):
        return
    if state.iteration < study.iterations:
        fresh = [*job.overrides, f"output_dir={runs}"]
        further = [f"resume={state.folder}", f"run.iterations={study.iterations}"]
        begun = time.time()
        _command("camp.train", fresh if state.folder is None else further, job, runs)
        state = state_of(job, runs)
        _note_seconds(state.folder, begun)
    begun = time.time()
    _command("camp.evaluate", [f"run={state.folder}", "video=false", *study.evaluation], job, runs)
    _note_seconds(state.folder, begun)


def _command(module: str, arguments: Sequence[str], job: Job, runs: Path) -> None:
    command, path = [sys.executable, "-m", module, *arguments], runs / f"{job.arm}-seed{job.seed}.log"
    print(f"{job.arm} seed {job.seed}: {shlex.join(['python', *command[1:]])}", flush=True)
    make_folder(runs)
    with path.open("ab") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        try:
            code = process.wait()
        except KeyboardInterrupt:  # Ctrl-C reaches the process, too, which saves a checkpoint before it ends
            process.wait()
            raise
    if code == EXIT_INTERRUPTED:
        raise KeyboardInterrupt
    if code != 0:
        last = (path.read_text(encoding="utf-8", errors="replace").strip().splitlines() or ["no message"])[-1]
        raise StudyError(f"{job.arm} seed {job.seed}: {module} ended with code {code} ({last}); see {path}")


def _note_seconds(folder: Path | None, begun: float) -> None:
    if folder is not None:
        path = folder / SECONDS
        before = path.read_text(encoding="utf-8") if path.is_file() else ""
        write_text(path, f"{before}{time.time() - begun:.1f}\n")


def seconds_of(folder: Path) -> float:
    """Wall-clock s of all stretches that ended; one that was cut off is not in it."""
    path = folder / SECONDS
    return sum(map(float, path.read_text(encoding="utf-8").split())) if path.is_file() else 0.0
