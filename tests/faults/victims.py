"""Commands that are killed: what each is, when, and what must hold afterwards."""

from __future__ import annotations

import json
import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from camp.runs.checkpoint import list_checkpoints, load_checkpoint
from camp.runs.folder import METRICS
from camp.runs.state import load_state
from tests.faults.nursery import Job, Nursery

SEED = 0
POLL_S = 0.002
TINY = (
    *("run=smoke", "sim=cpu", "sim.num_envs=4", "sim.threads=1", "logger.wandb_mode=disabled"),
    *("run.rollout_steps=8", "run.checkpoint_every=1", "run.gait_every=2", "motion.num_preloaded=400"),
    *("motion.skills=[trot]", "motion.frequencies_hz=[2]", "algo.embedding_size=12"),
    *("algo.actor.hidden=[32,16]", "algo.critic.hidden=[8]", "algo.style.hidden=[8]", "algo.skill.hidden=[8]"),
)


@dataclass
class Count:
    """Kills of one phase: how many commands were started to be killed, and how many of them were still running."""

    phase: str
    promise: str
    tried: int = 0
    killed: int = 0
    notes: dict[str, int] = field(default_factory=dict)

    def add(self, alive: bool, note: str = "") -> None:
        """Take in one of them."""
        self.tried += 1
        self.killed += alive
        if alive and note:
            self.notes[note] = self.notes.get(note, 0) + 1


def chance_of(phase: str) -> random.Random:
    """Where a phase's moments come from: the same ones in every campaign."""
    return random.Random(f"{SEED}/{phase}")


def kill_when(job: Job, seen: Callable[[], bool], delay_s: float) -> bool:
    """SIGKILL `delay_s` s after something is seen; returns whether the command was still running."""
    while not seen():
        if job.ended():
            return False
        time.sleep(POLL_S)
    time.sleep(delay_s)
    job.kill()
    return job.code == -9


def train(nursery: Nursery, folder: Path, *arguments: str) -> Job:
    """Start a training below a folder."""
    return nursery.start(["camp.train", *TINY, *arguments], folder, "train")


def resume(nursery: Nursery, run: Path, iterations: int, folder: Path | None = None) -> Job:
    """Continue a run up to an iteration; folder: for the log, by default the one above outputs/."""
    command = ["camp.train", f"resume={run}", f"run.iterations={iterations}"]
    return nursery.start(command, folder or run.parents[1], "train")


def only_run(folder: Path) -> Path | None:
    """The newest run below a folder with something to continue; None where there is none."""
    runs = [path for path in sorted(folder.glob("outputs/2*")) if list_checkpoints(path)]
    return runs[-1] if runs else None


def iterations_in(folder: Path) -> int:
    """Lines of metrics so far."""
    files = sorted(folder.glob(f"outputs/2*/{METRICS}"))
    return files[-1].read_bytes().count(b"\n") if files else 0


def metrics_of(run: Path) -> list[dict[str, Any]]:
    """Everything but the times."""
    rows = [json.loads(line) for line in (run / METRICS).read_text().splitlines()]
    return [{key: value for key, value in row.items() if not key.startswith("time/")} for row in rows]


def assert_same_run(run: Path, other: Path) -> None:
    """Bit for bit: every metric of every iteration, and all that the last checkpoint holds."""
    assert metrics_of(run) == metrics_of(other)
    _assert_same(load_checkpoint(run), load_checkpoint(other), "state")


def assert_can_be_continued(run: Path) -> int:
    """Every file of a killed run is whole; returns the iteration that it continues after."""
    for path in list_checkpoints(run):
        load_checkpoint(path)
    return load_state(run).iteration


def _assert_same(one: Any, other: Any, where: str) -> None:
    assert type(one) is type(other), where
    if isinstance(one, torch.Tensor):
        assert one.dtype == other.dtype and torch.equal(one, other), where
    elif isinstance(one, dict):
        assert one.keys() == other.keys(), where
        for key in one:
            _assert_same(one[key], other[key], f"{where}.{key}")
    elif isinstance(one, (list, tuple)):
        assert len(one) == len(other), where
        for index, pair in enumerate(zip(one, other, strict=True)):
            _assert_same(*pair, f"{where}[{index}]")
    else:
        assert one == other, where
