"""Train a policy: ``python -m camp.train [overrides]``; see conf/train.yaml."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import torch
from omegaconf import DictConfig

from camp.build import Training, build_training
from camp.checkpoint import load_checkpoint
from camp.cli import new_run_folder, run_hydra
from camp.config import Config, as_yaml, load_run_config, resolve
from camp.errors import CheckpointError
from camp.logger import RunIdentity, RunLogger
from camp.progress import Progress
from camp.runner import Runner
from camp.seeding import seed_everything
from camp.warm_start import warm_start


def train(composed: DictConfig) -> Path:
    """Train as configured, or continue the run that ``resume`` names; returns the run folder."""
    config = resolve(composed)
    resumed = Path(config.resume) if config.resume else None
    if resumed is not None:
        config = load_run_config(resumed)
    set_threads(config.sim.threads)
    seed_everything(config.seed)
    checkpoint = load_checkpoint(resumed) if resumed is not None else None
    training = build_training(config)
    try:
        if resumed is None:
            warm_start(training, config)
            folder = new_run_folder(Path(config.output_dir), f"{config.variant}-seed{config.seed}")
        else:
            folder = resumed
        runner = Runner(training, config, folder)
        if checkpoint is None:
            runner.start()
        else:
            _restore(runner, checkpoint)
        _run(runner, config, resume_from=runner.iteration if checkpoint is not None else None)
    finally:
        training.env.close()
    return folder


def set_threads(threads: int) -> None:
    """Give torch's operations as many threads as the simulator has; 0 leaves one per processor to both."""
    if threads > 0:
        torch.set_num_threads(threads)


def _run(runner: Runner, config: Config, resume_from: int | None) -> None:
    identity = RunIdentity(runner.folder, group=config.variant, tags=[f"seed{config.seed}"])
    steps = config.run.rollout_steps * config.sim.num_envs
    print(f"run folder: {runner.folder}", flush=True)
    print(f"preloaded transitions: {_preloaded(runner.training)}", flush=True)
    with (
        RunLogger(identity, config.logger, as_yaml(config), resume_from) as logger,
        Progress(config.run.iterations, steps) as progress,
        _stop_signals() as stopping,
    ):
        runner.train(logger, progress, lambda: bool(stopping))
    if stopping:
        print(f"stopped at iteration {runner.iteration}; continue with: python -m camp.train resume={runner.folder}")
        raise KeyboardInterrupt


def _preloaded(training: Training) -> str:
    demonstrations = training.demonstrations
    return f"{len(demonstrations):,} ({demonstrations.memory_bytes / 2**20:.0f} MiB)"


def _restore(runner: Runner, checkpoint: dict) -> None:
    try:
        runner.load_state_dict(checkpoint)
    except (KeyError, RuntimeError, ValueError) as error:
        reason = str(error).strip().splitlines()[0]
        raise CheckpointError(
            f"run folder {runner.folder}: its checkpoint does not fit its config.yaml ({reason}); "
            "restore the original file"
        ) from error


@contextmanager
def _stop_signals() -> Iterator[list[int]]:
    """Let Ctrl-C and ``kill`` end training between two iterations; a second one acts at once."""
    received: list[int] = []

    def note(number: int, _frame: object) -> None:
        received.append(number)
        for name in (signal.SIGINT, signal.SIGTERM):
            signal.signal(name, previous[name])

    previous = {name: signal.signal(name, note) for name in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    finally:
        for name, handler in previous.items():
            signal.signal(name, handler)


if __name__ == "__main__":
    sys.exit(run_hydra("train", train))
