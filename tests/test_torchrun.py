"""Training in two processes as it is typed: one run folder, one record, exact resuming."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import torch

from camp.build import build_training
from camp.common import distributed
from camp.config.compose import compose_config
from camp.runs.checkpoint import load_checkpoint
from camp.training.runner import Runner
from tests.algo.synthetic import assert_identical
from tests.ranks import in_ranks
from tests.test_train import (
    ENDLESS,
    TINY,
    Uninterrupted,
    environment,
    error_line,
    metrics_of,
    runs_in,
    wait_for_iteration,
)

TORCHRUN = str(Path(sys.executable).with_name("torchrun"))
SMOKE = ["run=smoke", *TINY, "logger.wandb_mode=disabled"]


def command(*arguments: str, processes: int = 2) -> list[str]:
    return [TORCHRUN, "--standalone", f"--nproc-per-node={processes}", "-m", "camp.train", *arguments]


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command(*arguments), cwd=folder, env=environment(), capture_output=True, text=True)


def train_a_little() -> dict[str, Any]:
    """What a rank has after three iterations: networks, and what it saw."""
    config = compose_config([*SMOKE, "algo.style.replay_size=64", "run.critic_warmup=1"])
    training = build_training(config)
    with torch.no_grad():  # as if this rank's processor had drawn other weights
        training.ppo.actor.log_std -= 0.1 * distributed.rank()
    runner = Runner(training, config, Path())
    runner.start()
    metrics = [runner.iterate() for _ in range(3)]
    shared = {"ppo": training.ppo.state_dict(), "priors": [prior.state_dict() for prior in training.priors]}
    steady = [{key: value for key, value in row.items() if not key.startswith("time/")} for row in metrics]
    return {"shared": shared, "metrics": steady, "seen": training.env.observation}


@pytest.mark.slow
def test_ranks_see_different_robots_and_hold_the_same_networks(tmp_path):
    first, second = in_ranks(train_a_little, tmp_path)
    assert_identical(first["shared"], second["shared"])
    assert first["metrics"] == second["metrics"]
    assert first["seen"].shape == (4, 49) and not torch.equal(first["seen"], second["seen"])


IMITATING = [
    *("algo.imitation.epochs=1", "algo.imitation.batch_size=4096", "motion.perturbed_clips=1"),
    "algo.imitation.ppo_weight=1",
]
LONG = [*SMOKE, *IMITATING, "run.checkpoint_every=1", "run.checkpoints_kept=3"]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory) -> Uninterrupted:
    """Two processes that nobody stops."""
    reference = Uninterrupted(tmp_path_factory.mktemp("uninterrupted"), command(*LONG))
    reference.rows(12)
    return reference


@pytest.mark.slow
def test_two_processes_are_one_run(uninterrupted):
    folder, printed = uninterrupted.run, uninterrupted.output
    assert len((folder / "imitation.jsonl").read_text().splitlines()) == 1
    assert printed.count("pairs, loss") == 1
    rows = metrics_of(folder)
    assert [row["iteration"] for row in rows] == list(range(1, 13))
    assert rows[-1]["steps"] == 12 * 8 * 8
    assert rows[-1]["ppo/auxiliary_loss"] > 0.0
    assert printed.count("run folder:") == printed.count("iteration 12/12") == 1
    assert len(load_checkpoint(folder)["ranks"]) == 2


@pytest.mark.slow
def test_another_number_of_processes_is_refused(uninterrupted, capsys):
    line = error_line([f"resume={uninterrupted.run}"], capsys)
    assert "trained by 2 processes" in line and "torchrun --nproc-per-node=2" in line


@pytest.mark.slow
def test_a_stopped_or_killed_run_continues_as_if_nothing_had_happened(uninterrupted, tmp_path):
    begun = command(*LONG, f"run.iterations={ENDLESS}")
    stopped = subprocess.Popen(begun, cwd=tmp_path, env=environment(), stdout=subprocess.PIPE, text=True)
    folder = wait_for_iteration(tmp_path, stopped, 3)
    stopped.send_signal(signal.SIGTERM)
    output, _ = stopped.communicate()
    assert stopped.returncode != 0 and "continue with: torchrun --nproc-per-node=2" in output
    reached = len(metrics_of(folder))
    assert reached >= 3 and len(load_checkpoint(folder)["ranks"]) == 2

    resume = f"resume={folder}"
    killed = subprocess.Popen(command(resume), cwd=tmp_path, env=environment(), stderr=subprocess.PIPE, text=True)
    wait_for_iteration(tmp_path, killed, reached + 2)
    children = Path(f"/proc/{killed.pid}/task/{killed.pid}/children").read_text().split()
    subprocess.run(["kill", "-KILL", children[-1]], check=True)
    _, errors = killed.communicate()
    assert killed.returncode != 0
    assert "error: rank 0: the other processes cannot be reached" in errors

    iterations = len(metrics_of(folder)) + 2
    resumed = run(tmp_path, resume, f"run.iterations={iterations}")
    assert resumed.returncode == 0, resumed.stderr
    assert metrics_of(folder)[-1]["ppo/auxiliary_loss"] > 0.0
    assert metrics_of(folder) == uninterrupted.rows(iterations)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["sim.num_envs=9"], "sim.num_envs = 9: the 2 processes share it equally; choose a multiple of 2"),
        (["-m", "seed=0,1"], "--multirun under torchrun"),
    ],
)
def test_what_ranks_cannot_do_is_told_and_leaves_nothing(arguments, words, tmp_path):
    done = run(tmp_path, *SMOKE, *arguments)
    assert done.returncode != 0
    assert words in done.stderr and "Error executing" not in done.stderr
    assert runs_in(tmp_path) == []
