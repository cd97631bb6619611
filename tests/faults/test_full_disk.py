"""A disk that fills up, as a small tmpfs: one line, an exit code, and files as they were."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from camp.motion.clips.store import load_clip
from tests.errors import assert_one_line
from tests.faults.nursery import Job, Nursery
from tests.faults.test_products import SHORT, finish
from tests.faults.test_training import finished
from tests.faults.victims import Count, assert_can_be_continued, assert_same_run, only_run, resume, train

ITERATIONS = 8


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A tmpfs of 8 MiB."""
    place = tmp_path / "disk"
    place.mkdir()
    try:
        mounted = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", str(place)], capture_output=True, text=True
        )
    except FileNotFoundError:
        pytest.skip("there is no command to mount a tmpfs")
    if mounted.returncode:
        pytest.skip(f"a tmpfs cannot be mounted here: {mounted.stderr.strip()}")
    try:
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


def fill(disk: Path, leave: int = 0) -> None:
    """Write a file that leaves so many bytes."""
    status = os.statvfs(disk)
    (disk / "ballast").write_bytes(bytes(max(status.f_bavail * status.f_frsize - leave, 0)))


def assert_full(job: Job) -> None:
    """It ends with exit code 2 and one line that says why."""
    assert job.wait() == 2, job.output
    errors = [line for line in job.output.splitlines(keepends=True) if "error: " in line]
    assert "Traceback" not in job.output, job.output
    assert_one_line("".join(errors), "No space left on device")


def test_training_on_a_full_disk(nursery: Nursery, tmp_path: Path, disk: Path, count: Count):
    """One line, exit code 2; with space again the run goes on and equals an undisturbed one, bit for bit."""
    job = train(nursery, tmp_path, f"run.iterations={ITERATIONS}", f"output_dir={disk / 'outputs'}")
    while not job.ended() and only_run(disk) is None:
        pass
    fill(disk, leave=60_000)
    assert_full(job)
    run = only_run(disk)
    assert run is not None and assert_can_be_continued(run) < ITERATIONS
    (disk / "ballast").unlink()
    last = resume(nursery, run, ITERATIONS, tmp_path)
    assert last.wait() == 0, last.output
    assert_same_run(run, finished(nursery, tmp_path / "undisturbed", ITERATIONS))
    count.add(True)


def test_products_on_a_full_disk(nursery: Nursery, tmp_path: Path, disk: Path, count: Count, campaign: None):
    """Evaluation, export, figures and clips: one line, an exit code, and what was there stays as it was."""
    job = train(nursery, tmp_path, "run.iterations=1", f"output_dir={disk / 'outputs'}")
    assert job.wait() == 0, job.output
    run = only_run(disk)
    assert run is not None
    commands = {
        "evaluate": ["camp.evaluate", f"run={run}", *SHORT],
        "export": ["camp.export", f"run={run}"],
        "figures": ["analysis", f"run={run}", "only=training"],
        "clips": ["camp.dataset", "--only", "trot_2hz_forward_0.6", "--overwrite", f"--folder={disk / 'clips'}"],
    }
    for command in commands.values():
        finish(nursery, command, tmp_path)
    fill(disk)
    before = {path: path.read_bytes() for path in disk.rglob("*") if path.is_file()}
    for name, command in commands.items():
        job = nursery.start(command, tmp_path, name)
        if name == "clips":
            assert job.wait() == 1 and "No space left on device" in job.output
        else:
            assert_full(job)
        assert {path: path.read_bytes() for path in disk.rglob("*") if path.is_file()} == before, name
        count.add(True)
    for path in (disk / "clips").glob("*.npz"):
        load_clip(path)
