"""A run folder with a small policy that was never trained, for what reads run folders."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch
from omegaconf import OmegaConf

from camp.algo.models import GaussianActor
from camp.build import build_training
from camp.config.compose import compose_config
from camp.config.resolve import as_yaml
from camp.envs.quadruped import QuadrupedEnv
from camp.runs.checkpoint import save_run_checkpoint
from camp.training.runner import Runner

OVERRIDES = (
    "run=smoke",
    "sim.num_envs=4",
    "sim.threads=1",
    "motion.num_preloaded=400",
    "algo.actor.hidden=[32,16]",
    "algo.critic.hidden=[8]",
    "algo.style.hidden=[8]",
    "algo.skill.hidden=[8]",
    "algo.embedding_size=12",
    "logger.wandb_mode=disabled",
)


def small_run(folder: Path, overrides: Sequence[str] = ()) -> Path:
    """Write a run folder: configuration and one checkpoint, whose policy swings the legs by a few tenths of a rad."""
    config = compose_config([*OVERRIDES, *overrides])
    training = build_training(config)
    runner = Runner(training, config, folder)
    actor = training.ppo.actor
    actor.normalizer.update(environment_observations(training.env))
    enliven(actor)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "config.yaml").write_text(OmegaConf.to_yaml(as_yaml(config)))
    save_run_checkpoint(folder, 7, runner.state().as_dict() | {"iteration": 7}, keep=1)
    training.env.close()
    return folder


def enliven(actor: GaussianActor) -> None:
    """Enlarge a fresh actor's answers, which are close to 0, to about 1."""
    head = actor.network[-1]
    assert isinstance(head, torch.nn.Linear)
    with torch.no_grad():
        head.weight.mul_(20.0)


def environment_observations(env: QuadrupedEnv, steps: int = 25) -> torch.Tensor:
    """What the policy sees of robots that are thrown into motion, noise and all, (steps x N, 45 + K)."""
    seen = [env.reset(seed=1)[0]]
    noise = torch.Generator().manual_seed(2)
    for _ in range(steps):
        seen.append(env.advance(torch.randn(env.num_envs, 12, generator=noise)).observation)
    return torch.cat(seen)
