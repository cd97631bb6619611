"""Behaviour cloning: regression of the actor on the expert's targets, before PPO and as an auxiliary loss."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from camp.algo.config import ImitationConfig
from camp.algo.models import GaussianActor
from camp.algo.ppo import minibatches
from camp.common.averages import Averages


@dataclass
class ImitationData:
    """Expert pairs on the actor's device."""

    observation: Tensor  # (M, H O) as the environment would give it: H control steps, the oldest first
    action: Tensor  # (M, A) the expert's clean answer, action units
    last_action: slice  # where a control step's O numbers hold the previous action
    sensor_noise: Tensor  # (O,) half-width of the uniform noise that the environment's sensors have


def imitate(
    actor: GaussianActor, data: ImitationData, config: ImitationConfig, generator: torch.Generator
) -> Iterator[dict[str, float]]:
    """Fits the actor's mean to the expert's actions (squared error, Adam, cosine rate); yields per epoch.

    The last action all but gives the next one away, and a clone that leans on it repeats its own errors in
    closed loop: noise on that input (fresh in every minibatch) keeps it useful without being trusted. The
    actor's normalizer is fed once, with observations noised the same way; its exploration std is not touched.

    generator: on the actor's device. Raises ValueError where there are no pairs.
    """
    pairs = data.observation.shape[0]
    if pairs == 0:
        raise ValueError("imitate: no (observation, action) pairs; generate clips first")
    actor.normalizer.update(_noised(data.observation, data, config, generator))
    optimizer = torch.optim.Adam(actor.network.parameters(), lr=config.learning_rate, fused=True)
    per_epoch = math.ceil(pairs / config.batch_size)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, T_max=per_epoch * config.epochs)
    for epoch in range(config.epochs):
        averages = Averages()
        for index in minibatches(pairs, 1, per_epoch, generator):
            loss = _loss(actor, index, data, config, generator)
            optimizer.zero_grad(set_to_none=True)
            loss.backward()
            optimizer.step()
            schedule.step()
            averages.add("imitation/loss", loss)
        yield averages.result() | {
            "imitation/epoch": float(epoch + 1),
            "imitation/learning_rate": schedule.get_last_lr()[0],
        }


class ImitationLoss:
    """Holds what imitation has taught while PPO improves it: the same loss, weighted, on a fresh batch at every call.

    PPO's own samples soon show only what the policy does, and the rewards hardly hold it to the expert's stride
    frequency; pairs of the expert beside them do (DAPG, Rajeswaran et al. 2018, there with a decaying weight).
    """

    def __init__(self, data: ImitationData, config: ImitationConfig, generator: torch.Generator) -> None:
        """generator: on the actor's device."""
        self.data, self.config, self.generator = data, config, generator

    def __call__(self, actor: GaussianActor) -> Tensor:
        """ppo_weight x mean squared error of the actor's mean on ``batch_size`` pairs, ()."""
        pairs, device = self.data.observation.shape[0], self.generator.device
        index = torch.randint(pairs, (self.config.batch_size,), generator=self.generator, device=device)
        return self.config.ppo_weight * _loss(actor, index, self.data, self.config, self.generator)


def _loss(
    actor: GaussianActor, index: Tensor, data: ImitationData, config: ImitationConfig, generator: torch.Generator
) -> Tensor:
    observation = _noised(data.observation.index_select(0, index), data, config, generator)
    return functional.mse_loss(actor(observation), data.action.index_select(0, index))


def _noised(observation: Tensor, data: ImitationData, config: ImitationConfig, generator: torch.Generator) -> Tensor:
    frames = observation.unflatten(1, (-1, len(data.sensor_noise)))
    uniform = 2.0 * torch.rand(frames.shape, generator=generator, device=observation.device) - 1.0
    noised = frames + data.sensor_noise * uniform
    part = noised[:, :, data.last_action]
    part += config.last_action_noise * torch.randn(part.shape, generator=generator, device=part.device)
    return noised.flatten(1)
