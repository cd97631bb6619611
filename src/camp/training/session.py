"""A training from its start, or from its last checkpoint, to its end."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from camp.build import Training, build_training
from camp.common import distributed
from camp.common.commands import command, torchrun
from camp.common.errors import CheckpointError, ConfigError
from camp.common.files import folder_lock, write_text
from camp.common.progress import phase
from camp.common.seeding import seed_everything
from camp.common.threads import set_threads
from camp.config.resolve import as_yaml, load_run_config
from camp.config.schema import Config
from camp.runs.checkpoint import INCOMPATIBLE, incompatible
from camp.runs.folder import IMITATION, check_root, new_run_folder
from camp.runs.logger import NoLogger, RunLogger
from camp.runs.state import TrainingState, load_state
from camp.runs.wandb_run import RunIdentity
from camp.training.progress import Progress
from camp.training.runner import Runner
from camp.training.signals import stop_signals
from camp.training.warm_start import keep_imitating, warm_start

FEWEST_TRANSITIONS = 50  # of a skill, 1 s: two strides of the slowest gaits


def start(config: Config) -> Path:
    """Train a new policy; returns its run folder. Raises CampError."""
    if distributed.is_first():
        check_root(Path(config.output_dir))
    training = _training(config)
    imitation, folder = distributed.on_first(lambda: _begin(training, config))
    keep_imitating(training, config)
    runner = Runner(training, config, folder)
    runner.start()
    with _folder(runner), _logger(runner) as logger:
        if distributed.is_first():
            write_text(runner.folder / IMITATION, "".join(json.dumps(row) + "\n" for row in imitation))
        runner.save()
        _run(runner, logger)
    return runner.folder


def _begin(training: Training, config: Config) -> tuple[list[dict[str, float]], Path]:
    """What happens once, whatever the number of ranks: imitation, and then the run folder."""
    imitation = warm_start(training, config)
    return imitation, new_run_folder(Path(config.output_dir), f"{config.variant}-seed{config.seed}")


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
    state = load_state(folder)
    _check_ranks(state, folder)
    if state.iteration >= config.run.iterations:
        distributed.announce(
            f"{folder} has all its {config.run.iterations} iterations; add more with run.iterations=<number>"
        )
        return folder
    training = _training(config)
    keep_imitating(training, config)
    runner = Runner(training, config, folder)
    _restore(runner, state)
    with _folder(runner), _logger(runner, resume_from=runner.iteration) as logger:
        _run(runner, logger)
    return folder


def _training(config: Config) -> Training:
    set_threads(config.sim.threads)
    seed_everything(config.seed)
    with phase("reading clips and building the robots") if distributed.is_first() else nullcontext():
        return build_training(config)


def _folder(runner: Runner) -> AbstractContextManager[None]:
    """The run folder, for one training at a time."""
    return folder_lock(runner.folder, wait=False) if distributed.is_first() else nullcontext()


def _logger(runner: Runner, resume_from: int | None = None) -> RunLogger | NoLogger:
    if not distributed.is_first():
        return NoLogger()
    config = runner.config
    print(f"run folder: {runner.folder}", flush=True)
    identity = RunIdentity(runner.folder, group=config.variant, tags=[f"seed{config.seed}"])
    return RunLogger(identity, config.logger, as_yaml(config), resume_from)


def _run(runner: Runner, logger: RunLogger | NoLogger) -> None:
    run = runner.config.run
    distributed.announce(f"preloaded transitions: {_preloaded(runner.training)}")
    steps = run.rollout_steps * runner.config.sim.num_envs
    with (
        open(os.devnull, "w") as nowhere,
        Progress(run.iterations, steps, stream=None if distributed.is_first() else nowhere) as progress,
        stop_signals() as stopping,
    ):
        runner.train(logger, progress, lambda: bool(stopping))
    if distributed.anywhere(bool(stopping)):
        distributed.announce(
            f"stopped at iteration {runner.iteration}; continue with: {_command(runner.folder, distributed.size())}"
        )
        raise KeyboardInterrupt
    distributed.announce(f"trained; evaluate it with: {command('camp.evaluate', run=runner.folder)}")


def _command(folder: Path, ranks: int) -> str:
    """How the training in a run folder is continued, for messages."""
    if ranks == 1:
        return command("camp.train", resume=folder)
    return torchrun(ranks, "camp.train", resume=folder)


def _preloaded(training: Training) -> str:
    demonstrations = training.demonstrations
    few = [f"{skill} has {count}" for skill, count in demonstrations.counts.items() if count < FEWEST_TRANSITIONS]
    note = f"; too few to show a gait's rhythm: {', '.join(few)}" if few else ""
    return f"{len(demonstrations):,} ({demonstrations.memory_bytes / 2**20:.0f} MiB){note}"


def _check_ranks(state: TrainingState, folder: Path) -> None:
    """Every rank continues its own episodes and random streams, so there must be as many as when it was saved."""
    if state.is_shipped:
        raise CheckpointError(
            f"run folder {folder}: a shipped policy holds nothing to continue the training from; continue the run that "
            "it was made of, or train anew"
        )
    if not state.ranks or not state.alarms:
        raise CheckpointError(
            f"run folder {folder}: its checkpoint is of an earlier camp, which can be evaluated but not continued; "
            "continue it with the commit in its versions.json, or train anew"
        )
    saved, here = len(state.ranks), distributed.size()
    if saved != here:
        raise CheckpointError(
            f"run folder {folder}: it was trained by {saved} process{'es' * (saved > 1)}, and here are {here}; "
            f"continue it with as many: {_command(folder, saved)}"
        )


def _restore(runner: Runner, state: TrainingState) -> None:
    try:
        runner.restore(state)
    except INCOMPATIBLE as error:
        raise incompatible(runner.folder, error) from error
