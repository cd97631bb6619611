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
from tests.errors import assert_one_line
from tests.ranks import in_ranks
from tests.test_train import TINY, environment, metrics_of, runs_in, wait_for_checkpoint

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


@pytest.mark.slow
def test_two_processes_are_one_run(tmp_path):
    imitation = ["algo.imitation.epochs=1", "algo.imitation.batch_size=4096", "motion.perturbed_clips=1"]
    imitation += ["algo.imitation.ppo_weight=1"]
    done = run(tmp_path, *SMOKE, *imitation)
    assert done.returncode == 0, done.stderr
    (folder,) = runs_in(tmp_path)
    assert len((folder / "imitation.jsonl").read_text().splitlines()) == 1
    assert done.stdout.count("pairs, loss") == 1
    rows = metrics_of(folder)
    assert [row["iteration"] for row in rows] == [1, 2, 3, 4, 5]
    assert rows[-1]["steps"] == 5 * 8 * 8
    assert rows[-1]["ppo/auxiliary_loss"] > 0.0
    assert done.stdout.count("run folder:") == done.stdout.count("iteration 5/5") == 1
    assert len(load_checkpoint(folder)["ranks"]) == 2

    alone = subprocess.run(
        [sys.executable, "-m", "camp.train", f"resume={folder}"], env=environment(), capture_output=True, text=True
    )
    assert alone.returncode == 2
    assert_one_line(alone.stderr)
    assert "trained by 2 processes" in alone.stderr and "torchrun --nproc-per-node=2" in alone.stderr

    longer = run(tmp_path, f"resume={folder}", "run.iterations=6")
    assert longer.returncode == 0, longer.stderr
    assert metrics_of(folder)[-1]["ppo/auxiliary_loss"] > 0.0


@pytest.mark.slow
def test_a_stopped_or_killed_run_continues_as_if_nothing_had_happened(tmp_path):
    straight, broken = tmp_path / "straight", tmp_path / "broken"
    straight.mkdir(), broken.mkdir()
    long = [*SMOKE, "run.iterations=40", "run.checkpoint_every=1", "run.checkpoints_kept=80"]
    assert run(straight, *long).returncode == 0

    stopped = subprocess.Popen(command(*long), cwd=broken, env=environment(), stdout=subprocess.PIPE, text=True)
    folder = wait_for_checkpoint(broken, stopped, 3)
    stopped.send_signal(signal.SIGTERM)
    output, _ = stopped.communicate(timeout=180)
    assert stopped.returncode != 0 and "continue with: torchrun --nproc-per-node=2" in output
    reached = len(metrics_of(folder))
    assert reached < 35 and len(load_checkpoint(folder)["ranks"]) == 2

    resume = f"resume={folder}"
    killed = subprocess.Popen(command(resume), cwd=broken, env=environment(), stderr=subprocess.PIPE, text=True)
    wait_for_checkpoint(broken, killed, reached + 2)
    children = Path(f"/proc/{killed.pid}/task/{killed.pid}/children").read_text().split()
    subprocess.run(["kill", "-KILL", children[-1]], check=True)
    _, errors = killed.communicate(timeout=180)
    assert killed.returncode != 0 and len(metrics_of(folder)) < 40
    assert "error: rank 0: the other processes cannot be reached" in errors

    assert run(broken, resume).returncode == 0
    (other,) = runs_in(straight)
    assert metrics_of(folder) == metrics_of(other)


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
