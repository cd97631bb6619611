"""The same updates by one process on all the data and by two ranks on half each: tests/common/test_distributed.py."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any

import torch
from torch import Tensor

from camp.algo import skill, style
from camp.algo.losses import gradient_penalty
from camp.algo.ppo import PPO, minibatches
from camp.common import distributed
from camp.data import Rollout, Transition, concatenate
from tests.algo.synthetic import STATE_SIZE, four_corners, make_ppo, make_rollout, make_skill, make_style, rng

RANKS, UPDATES, ENVS = 2, 3, 16


def halves() -> list[int]:
    """Which halves of the data this process has."""
    return [distributed.rank()] if distributed.size() == RANKS else list(range(RANKS))


def join(parts: list[Any]) -> Any:
    """The halves' parts of a rollout or tensor (T, N / 2, ...) side by side."""
    if isinstance(parts[0], Tensor):
        return torch.cat(parts, dim=1)
    return replace(parts[0], **{f.name: join([getattr(p, f.name) for p in parts]) for f in fields(parts[0])})


class HalvesPPO(PPO):
    """Each minibatch consists of the minibatches that the ranks would draw from their halves of the rollout."""

    def _indices(self, return_: Tensor, generator: torch.Generator) -> Iterator[Tensor]:
        steps, envs = return_.shape
        own = envs // len(halves())
        drawn = [minibatches(steps * own, self.config.epochs, self.config.minibatches, rng(half)) for half in halves()]
        for parts in zip(*drawn, strict=True):
            # Row t * own + n of half h is row t * envs + h * own + n of all.
            yield torch.cat([part // own * envs + h * own + part % own for h, part in enumerate(parts)])


def update_ppo() -> dict[str, Any]:
    """State and metrics after some updates of policy and critic, with halves whose scales differ."""
    small = make_ppo(desired_kl=2e-3, learning_rate=1e-3)
    ppo = HalvesPPO(small.actor, small.critic, small.config)
    metrics = []
    for seed in range(UPDATES):
        rollouts = [_half_rollout(ppo, seed, half) for half in halves()]
        rollout: Rollout = join(rollouts)
        return_ = 30.0 * rollout.task_reward + 10.0 * rollout.observation[..., 0]
        if seed == 0:
            metrics.append(ppo.update_critic(rollout, return_, rng()))
        metrics.append(ppo.update(rollout, return_ - rollout.value, return_, rng()))
    return {"state": ppo.state_dict(), "metrics": metrics}


def _half_rollout(ppo: PPO, seed: int, half: int) -> Rollout:
    return make_rollout(ppo, 10 * seed + half, envs=ENVS // RANKS, scale=1.0 + half)


class HalvesMotion:
    """Demonstrations whose n-th draw is that of each half, of which the second lies apart."""

    def __init__(self) -> None:
        self.generators = [rng(half) for half in range(RANKS)]

    def sample(self, n: int, generator: torch.Generator) -> Transition:
        own = [four_corners().sample(n // len(halves()), self.generators[half]) for half in halves()]
        return concatenate([Transition((1.0 + h) * one.state, one.skill) for h, one in zip(halves(), own, strict=True)])


def update_priors() -> dict[str, Any]:
    """State and metrics of both priors after some updates; what they draw at random is drawn half by half."""
    motion, size = HalvesMotion(), 32 // (RANKS // len(halves()))
    policy = HalvesMotion()
    policy.generators = [rng(100 + half) for half in range(RANKS)]
    for module in (style, skill):
        module.draw = lambda transition, n, generator: policy.sample(n, generator)
    # The random signs of a vector's penalty are drawn in another order; the sum of its entries needs none.
    skill.gradient_penalty = lambda output, inputs, generator: gradient_penalty(output.sum(dim=1), inputs)
    priors = [make_style(batch_size=size), make_skill(batch_size=size)]
    nothing = Transition(torch.zeros(0, 2, STATE_SIZE), torch.zeros(0, dtype=torch.int64))
    metrics = [prior.update(nothing, motion, rng()) for _ in range(UPDATES) for prior in priors]
    return {"state": [prior.state_dict() for prior in priors], "metrics": metrics}


def both() -> dict[str, Any]:
    """PPO's and the priors' updates."""
    saved = style.draw, skill.draw, skill.gradient_penalty
    try:
        return {"ppo": update_ppo(), "priors": update_priors()}
    finally:
        style.draw, skill.draw, skill.gradient_penalty = saved
