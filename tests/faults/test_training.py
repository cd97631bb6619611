"""Training, killed: nothing is lost but the iterations since the last checkpoint."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tests.faults.nursery import Job, Nursery
from tests.faults.victims import (
    Count,
    assert_can_be_continued,
    assert_same_run,
    chance_of,
    iterations_in,
    kill_when,
    only_run,
    resume,
    train,
)

FURTHER = 2  # iterations that a run gets on average between two kills
LATEST_S = 0.4  # after what was seen: an iteration or two


def finished(nursery: Nursery, folder: Path, iterations: int, *arguments: str) -> Path:
    """A run that nobody disturbs."""
    folder.mkdir(exist_ok=True)
    job = train(nursery, folder, f"run.iterations={iterations}", *arguments)
    assert job.wait() == 0, job.output
    run = only_run(folder)
    assert run is not None
    return run


def test_training(nursery: Nursery, tmp_path: Path, kills: int, count: Count):
    """The last checkpoint continues; after all kills metrics and networks equal an uninterrupted run's, bit for bit."""
    chance, iterations = chance_of("training"), FURTHER * kills + 2
    while count.killed < kills:
        run, reached = only_run(tmp_path), iterations_in(tmp_path)
        if run is None:
            job = train(nursery, tmp_path, f"run.iterations={iterations}")
        else:
            # What a checkpoint does not know is written again, so lines may be fewer at first.
            reached = assert_can_be_continued(run)
            if reached >= iterations:
                iterations += FURTHER
            job = resume(nursery, run, iterations)
        wanted = reached + chance.randint(0, 2)

        def seen(wanted: int = wanted, job=job) -> bool:
            return "preloaded" in job.output and iterations_in(tmp_path) >= wanted

        alive = kill_when(job, seen, chance.uniform(0.0, LATEST_S))
        assert alive or job.code == 0, job.output
        count.add(alive, "before the first checkpoint" if only_run(tmp_path) is None else "")
    run = only_run(tmp_path)
    if run is None:
        run = finished(nursery, tmp_path, iterations)
    else:
        last = resume(nursery, run, iterations)
        assert last.wait() == 0, last.output
    assert_same_run(run, finished(nursery, tmp_path / "undisturbed", iterations))


def test_checkpoint_writing(nursery: Nursery, tmp_path: Path, kills: int, count: Count, campaign: None):
    """Every checkpoint that has its name is whole; what the killed writer left goes with the next checkpoint."""
    chance = chance_of("checkpoint")
    iterations = 4
    while count.killed < min(kills, 8):
        run = only_run(tmp_path)
        iterations += 4
        if run is None:
            job = train(nursery, tmp_path, f"run.iterations={iterations}", "algo.critic.hidden=[2048,1024]")
        else:
            job = resume(nursery, run, iterations)

        def half_written(job: Job = job) -> bool:
            return any(tmp_path.glob(f"outputs/2*/checkpoints/*.{job.pid}.partial"))

        def seen(half_written: Callable[[], bool] = half_written) -> bool:
            return half_written() and only_run(tmp_path) is not None

        alive = kill_when(job, seen, chance.uniform(0.0, 0.02))
        count.add(alive, "with a half-written file" if half_written() else "")
        if (run := only_run(tmp_path)) is not None:
            assert_can_be_continued(run)
    run = only_run(tmp_path)
    assert run is not None
    last = resume(nursery, run, iterations + 1)
    assert last.wait() == 0, last.output
    assert not any(run.glob("checkpoints/*.partial"))


def test_imitation(nursery: Nursery, tmp_path: Path, kills: int, count: Count, campaign: None):
    """No run folder is left behind; started again it equals an uninterrupted run, bit for bit."""
    overrides = [
        "algo.imitation.epochs=40",
        "motion.perturbed_clips=1",
        f"motion.perturbed_folder={tmp_path / 'clips'}",
    ]
    reference = finished(nursery, tmp_path / "undisturbed", 1, *overrides)
    chance = chance_of("imitation")
    for number in range(min(kills, 4)):
        folder = tmp_path / f"{number}"
        folder.mkdir()
        job = train(nursery, folder, "run.iterations=1", *overrides)
        alive = kill_when(job, lambda job=job: "imitating" in job.output, chance.uniform(0.0, 1.0))
        count.add(alive)
        if alive:
            assert only_run(folder) is None or assert_can_be_continued(only_run(folder)) == 0
    run = finished(nursery, tmp_path / "again", 1, *overrides)
    assert_same_run(run, reference)
    assert (run / "imitation.jsonl").read_bytes() == (reference / "imitation.jsonl").read_bytes()
