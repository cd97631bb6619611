"""Train a policy: ``python -m camp.train [overrides]``, on its own or under torchrun; see conf/train.yaml."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig

from camp.cli.hydra_main import run_hydra
from camp.common import distributed
from camp.common.commands import command
from camp.common.errors import ConfigError
from camp.config.resolve import resolve
from camp.sim.choice import AUTO, why_no_gpu
from camp.training import session


def train(composed: DictConfig) -> Path:
    """Train as configured, or continue the run that ``resume`` names; returns the run folder."""
    config, hydra = resolve(composed), HydraConfig.get()
    with distributed.join():
        if hydra.mode == RunMode.MULTIRUN and distributed.size() > 1:
            raise ConfigError("--multirun under torchrun: several jobs cannot share its processes; start one at a time")
        if config.resume:
            return session.resume(Path(config.resume), hydra.overrides.task)
        if composed.sim.backend == AUTO:
            reason = why_no_gpu(config.device)
            distributed.announce(f"sim=auto: {config.sim.backend}" + (f" ({reason})" if reason else ""))
        return session.start(config)


def compare(folders: Sequence[Path]) -> None:
    """Say how the runs of a sweep are evaluated and put side by side."""
    if len(folders) < 2:
        return
    print(f"evaluate these {len(folders)} runs: {command('camp.evaluate', '-m', run=','.join(map(str, folders)))}")
    print(f"then compare them: {command('analysis.seeds', *map(str, folders))}", flush=True)


if __name__ == "__main__":
    sys.exit(run_hydra("train", train, after_sweep=compare))
