"""Surroundings that are not as usual: a run folder that was moved, no home, no place for temporary files."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from tests.faults.nursery import Nursery
from tests.faults.test_training import finished
from tests.faults.victims import TINY, assert_same_run, only_run, resume

STATM_PAGES = 1  # of /proc/<pid>/statm: pages in memory
MIB = 2**20


def test_a_moved_run_continues(nursery: Nursery, tmp_path: Path):
    run = finished(nursery, tmp_path / "first", 3)
    (tmp_path / "other place (1)").mkdir()
    moved = Path(shutil.move(run, tmp_path / "other place (1)" / "renamed"))
    job = resume(nursery, moved, 5, tmp_path)
    assert job.wait() == 0, job.output
    exported = nursery.start(["camp.export", f"run={moved}"], tmp_path, "export")
    assert exported.wait() == 0 and (moved / "policy.onnx").is_file(), exported.output
    assert_same_run(moved, finished(nursery, tmp_path / "undisturbed", 5))


@pytest.mark.parametrize("value", [None, "/nowhere"], ids=["unset", "missing"])
def test_without_a_home_or_a_place_for_temporary_files(nursery: Nursery, tmp_path: Path, value: str | None):
    surroundings = dict.fromkeys(("HOME", "TMPDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"), value)
    command = ["camp.train", *TINY, "run.iterations=1", "logger.wandb_mode=offline"]
    job = nursery.start(command, tmp_path, "train", **surroundings)
    assert job.wait() == 0, job.output
    assert only_run(tmp_path) is not None and "Traceback" not in job.output


def test_long_training_keeps_memory_and_file_handles(nursery: Nursery, tmp_path: Path, campaign: None):
    """2000 iterations: as many open files as at the start, and less than 5 MiB more memory."""
    if not Path("/proc/self/statm").exists():
        pytest.skip("needs /proc")
    small = [
        "run.rollout_steps=2",
        "sim.num_envs=1",
        "run.checkpoint_every=500",
        "run.gait_every=100",
        "algo.ppo.minibatches=1",
    ]
    job = nursery.start(["camp.train", *TINY, *small, "run.iterations=2000"], tmp_path, "train")
    process, seen = Path("/proc") / str(job.pid), {}
    while not job.ended():
        lines = job.output.splitlines()
        at = next((int(line.split()[1].split("/")[0]) for line in reversed(lines) if line.startswith("iteration ")), 0)
        if at >= 100 and at not in seen:
            try:
                pages = int((process / "statm").read_text().split()[STATM_PAGES])
                seen[at] = len(list((process / "fd").iterdir())), pages * os.sysconf("SC_PAGE_SIZE") / MIB
            except OSError:  # it has just ended
                break
    assert job.wait() == 0, job.output
    first, last = seen[min(seen)], seen[max(seen)]
    print(f"iterations {min(seen)} and {max(seen)}: {first} and {last} open files and MiB")
    assert max(seen) > 1900 and last[0] <= first[0] and last[1] - first[1] < 5.0
