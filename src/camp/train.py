"""Train a policy: ``python -m camp.train [overrides]``; see conf/train.yaml."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import torch
from hydra.core.hydra_config import HydraConfig
from omegaconf import DictConfig

from camp.build import Training, build_training
from camp.checkpoint import load_checkpoint
from camp.cli import new_run_folder, run_hydra
from camp.config import Config, as_yaml, load_run_config, resolve
from camp.errors import CheckpointError, ConfigError
from camp.logger import RunIdentity, RunLogger, write_text
from camp.progress import Progress
from camp.runner import Runner
from camp.seeding import seed_everything
from camp.sim.choice import AUTO, why_no_gpu
from camp.warm_start import warm_start


def train(composed: DictConfig) -> Path:
    """Train as configured, or continue the run that ``resume`` names; returns the run folder."""
    config = resolve(composed)
    if composed.sim.backend == AUTO and not config.resume:
        reason = why_no_gpu(config.device)
        print(f"sim=auto: {config.sim.backend}" + (f" ({reason})" if reason else ""), flush=True)
    if config.resume:
        return resume(Path(config.resume), HydraConfig.get().overrides.task)
    with _training(config) as training:
        imitation = warm_start(training, config)
        runner = Runner(
            training, config, new_run_folder(Path(config.output_dir), f"{config.variant}-seed{config.seed}")
        )
        runner.start()
        with _logger(runner) as logger:
            write_text(runner.folder / "imitation.jsonl", "".join(json.dumps(row) + "\n" for row in imitation))
            runner.save()
            _run(runner, logger)
    return runner.folder


def resume(folder: Path, overrides: Sequence[str]) -> Path:
    """Continue a run with its own configuration, but for ``run.iterations`` and ``logger``.

    Raises ConfigError for other overrides, CheckpointError where the run cannot be continued.
    """
    changes = [override for override in overrides if not override.startswith("resume=")]
    for change in changes:
        if not change.startswith(("run.iterations=", "logger.")):
            raise ConfigError(
                f"override {change!r} beside resume={folder}: a run continues with its own configuration, in which "
                "only run.iterations and logger.* may change; leave it out, or start a new run"
            )
    config = load_run_config(folder, changes)
    checkpoint = load_checkpoint(folder)
    if checkpoint["iteration"] >= config.run.iterations:
        print(f"{folder} has all its {config.run.iterations} iterations; add more with run.iterations=<number>")
        return folder
    with _training(config) as training:
        runner = Runner(training, config, folder)
        _restore(runner, checkpoint)
        with _logger(runner, resume_from=runner.iteration) as logger:
            _run(runner, logger)
    return folder


@contextmanager
def _training(config: Config) -> Iterator[Training]:
    set_threads(config.sim.threads)
    seed_everything(config.seed)
    training = build_training(config)
    try:
        yield training
    finally:
        training.env.close()


def set_threads(threads: int) -> None:
    """Give torch's operations as many threads as the simulator has; 0 leaves one per processor to both."""
    if threads > 0:
        torch.set_num_threads(threads)


def _logger(runner: Runner, resume_from: int | None = None) -> RunLogger:
    config = runner.config
    print(f"run folder: {runner.folder}", flush=True)
    identity = RunIdentity(runner.folder, group=config.variant, tags=[f"seed{config.seed}"])
    return RunLogger(identity, config.logger, as_yaml(config), resume_from)


def _run(runner: Runner, logger: RunLogger) -> None:
    run = runner.config.run
    print(f"preloaded transitions: {_preloaded(runner.training)}", flush=True)
    steps = run.rollout_steps * runner.config.sim.num_envs
    with Progress(run.iterations, steps) as progress, _stop_signals() as stopping:
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
