"""Proximal policy optimization with an asymmetric critic and a KL-adaptive learning rate of the policy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import torch
from torch import Tensor, nn

from camp.algo.config import ITERATION, MINIBATCH, PPOConfig
from camp.algo.losses import (
    clipped_surrogate_loss,
    clipped_value_loss,
    gaussian_entropy,
    gaussian_kl,
    gaussian_log_prob,
    symmetry_loss,
)
from camp.algo.mirror import Symmetry
from camp.algo.models import Critic, GaussianActor
from camp.algo.optimization import backward
from camp.common import distributed
from camp.common.averages import Averages
from camp.data import Decision, Rollout

AuxiliaryLoss = Callable[[GaussianActor], Tensor]  # () to be added to the surrogate's, once a minibatch

RATE_FACTOR = 1.5  # of one correction of the policy rate (legged_gym)


@dataclass
class _ActorBatch:
    observation: Tensor  # (B, O)
    action: Tensor  # (B, A)
    log_prob: Tensor  # (B,)
    action_mean: Tensor  # (B, A)
    action_std: Tensor  # (B, A)
    advantage: Tensor  # (B,)


@dataclass
class _CriticBatch:
    observation: Tensor  # (B, O)
    privileged: Tensor  # (B, X)
    value: Tensor  # (B,)
    return_: Tensor  # (B,)


Batch = TypeVar("Batch", _ActorBatch, _CriticBatch)


def _take(batch: Batch, index: Tensor) -> Batch:
    return type(batch)(*(getattr(batch, f.name).index_select(0, index) for f in fields(batch)))


def minibatches(size: int, epochs: int, count: int, generator: torch.Generator) -> Iterator[Tensor]:
    """Index sets: each epoch splits a fresh permutation of range(size) into `count` nearly equal parts."""
    for _ in range(epochs):
        order = torch.randperm(size, generator=generator, device=generator.device)
        yield from order.tensor_split(min(count, size))


def explained_variance(value: Tensor, return_: Tensor) -> Tensor:
    """1 - Var(R - V) / Var(R): 1 is a perfect critic, 0 no better than a constant. Any shape -> ()."""
    (_, unexplained, _), (_, all_, _) = (distributed.moments(x.reshape(-1, 1)) for x in (return_ - value, return_))
    return 1.0 - (unexplained / all_.clamp(min=1e-8)).squeeze()


def desired_kl_at(progress: float, config: PPOConfig) -> float:
    """The KL that the adaptive rule aims at, in nats, when the share ``progress`` in [0, 1) of the training is done."""
    settling = progress - (1.0 - config.settle_fraction)
    if config.final_desired_kl is None or settling <= 0.0:
        return config.desired_kl
    return config.desired_kl * (config.final_desired_kl / config.desired_kl) ** (settling / config.settle_fraction)


def no_auxiliary_loss(actor: GaussianActor) -> Tensor:
    """Nothing beside PPO's own objective."""
    return actor.std.new_zeros(())


class PPO:
    """Owns actor, critic and one optimizer for each.

    Apart, because the adaptive rule (Schulman et al. 2017, as in legged_gym) may hold the policy's rate near
    its floor for long, which must not slow the critic. Generators live on the networks' device.

    Normalizers move LAST in an update: the rollout's log-probabilities and values were computed with the old
    statistics, so with the old ones every measured ratio and KL is a change of the policy and of nothing
    else.
    """

    def __init__(
        self, actor: GaussianActor, critic: Critic, config: PPOConfig, symmetry: Symmetry | None = None
    ) -> None:
        """symmetry: of observations and actions; given where, and only where, `symmetry_weight` is not 0. Raises
        ValueError where it is not so."""
        if (config.symmetry_weight > 0.0) != (symmetry is not None):
            raise ValueError(f"algo.ppo.symmetry_weight = {config.symmetry_weight} with symmetry {symmetry}")
        self.actor, self.critic, self.config, self.symmetry = actor, critic, config, symmetry
        self.auxiliary_loss: AuxiliaryLoss = no_auxiliary_loss
        self.desired_kl = config.desired_kl  # that of the next update
        # GPU and CPU both have the fused kernel: one pass over the parameters instead of a dozen.
        trained = [p for p in actor.parameters() if p.requires_grad]
        self.actor_optimizer = torch.optim.Adam(trained, lr=config.learning_rate, fused=True)
        rate = config.critic_learning_rate
        self.critic_optimizer = torch.optim.Adam(critic.parameters(), lr=rate, fused=True)

    @torch.no_grad()
    def act(self, observation: Tensor, privileged: Tensor, generator: torch.Generator) -> Decision:
        """Samples actions for (N, O), (N, X)."""
        mean = self.actor(observation)
        std = self.actor.std.expand_as(mean)
        noise = torch.randn(mean.shape, generator=generator, device=mean.device, dtype=mean.dtype)
        action = mean + std * noise
        value = self.critic(observation, privileged)
        return Decision(action, gaussian_log_prob(action, mean, std), mean, std, value)

    @torch.no_grad()
    def value(self, observation: Tensor, privileged: Tensor) -> Tensor:
        """Critic's value (N,) of (N, O), (N, X), e.g. of final observations."""
        return self.critic(observation, privileged)

    @property
    def learning_rate(self) -> float:
        """Present rate of the policy."""
        return self.actor_optimizer.param_groups[0]["lr"]

    def set_learning_rate(self, value: float) -> None:
        """Sets the policy's rate, kept within the bounds (e.g. the floor at hand-over from imitation)."""
        bounded = min(max(value, self.config.min_learning_rate), self.config.max_learning_rate)
        for group in self.actor_optimizer.param_groups:
            group["lr"] = bounded

    def update(
        self, rollout: Rollout, advantage: Tensor, return_: Tensor, generator: torch.Generator
    ) -> dict[str, float]:
        """Improves policy and critic on one rollout; advantage, return_ (T, N). Returns metrics `ppo/...`."""
        averages = Averages()
        actor_batch = self._actor_batch(rollout, advantage)
        critic_batch = self._critic_batch(rollout, return_, averages)
        adaptive, each = self.config.adaptive, self.config.adapt_each
        kls: list[Tensor] = []  # () of each minibatch, before its step
        for i, index in enumerate(self._indices(return_, generator)):
            # Before the first step new and old policy are the same: a KL of 0 says nothing about the rate.
            adapt = adaptive and each == MINIBATCH and i > 0
            kls.append(self._actor_step(_take(actor_batch, index), averages, adapt))
            self._critic_step(_take(critic_batch, index), averages)
        if adaptive and each == ITERATION:
            self._adapt(torch.stack(kls[-self.config.minibatches :]).mean())
        self._observe(rollout, averages)
        if self.config.update_normalizer:
            self.actor.normalizer.update(rollout.observation)
        return averages.result() | {"ppo/learning_rate": self.learning_rate}

    def update_critic(self, rollout: Rollout, return_: Tensor, generator: torch.Generator) -> dict[str, float]:
        """Improves the critic alone: policy, its normalizer and its rate stay untouched.

        For the first iterations after a warm start by imitation, when a fresh critic's advantages are noise
        that would undo the imitation, and a KL of zero would drive the adaptive rate to its ceiling.
        """
        averages = Averages()
        batch = self._critic_batch(rollout, return_, averages)
        for index in self._indices(return_, generator):
            self._critic_step(_take(batch, index), averages)
        self._observe(rollout, averages)
        return averages.result() | {"ppo/learning_rate": self.learning_rate}

    def _observe(self, rollout: Rollout, averages: Averages) -> None:
        averages.add("ppo/rows_left_out", self.critic.observe(rollout.observation, rollout.privileged))

    def _indices(self, return_: Tensor, generator: torch.Generator) -> Iterator[Tensor]:
        return minibatches(return_.numel(), self.config.epochs, self.config.minibatches, generator)

    def _actor_batch(self, rollout: Rollout, advantage: Tensor) -> _ActorBatch:
        mean, variance, _ = distributed.moments(advantage.reshape(-1, 1))
        standardized = (advantage - mean) / (variance.sqrt() + 1e-8)
        return _ActorBatch(
            observation=rollout.observation.flatten(0, 1),
            action=rollout.action.flatten(0, 1),
            log_prob=rollout.log_prob.flatten(),
            action_mean=rollout.action_mean.flatten(0, 1),
            action_std=rollout.action_std.flatten(0, 1),
            advantage=standardized.to(advantage.dtype).flatten(),
        )

    def _critic_batch(self, rollout: Rollout, return_: Tensor, averages: Averages) -> _CriticBatch:
        self.critic.rescale(return_)
        with torch.no_grad():
            # What the value clip holds on to: the rollout's own values, but for the very first rescaling,
            # which moves a fresh critic to the mean return.
            value = self.critic(rollout.observation, rollout.privileged)
        averages.add("ppo/return", return_)
        averages.add("ppo/explained_variance", explained_variance(rollout.value, return_))
        return _CriticBatch(
            observation=rollout.observation.flatten(0, 1),
            privileged=rollout.privileged.flatten(0, 1),
            value=value.flatten(),
            return_=return_.flatten(),
        )

    def _actor_step(self, batch: _ActorBatch, averages: Averages, adapt: bool) -> Tensor:
        """One step of the policy; returns the KL before it, ()."""
        mean = self.actor(batch.observation)
        std = self.actor.std
        kl = gaussian_kl(batch.action_mean, batch.action_std, mean.detach(), std.detach()).mean()
        if adapt:
            self._adapt(kl)
        log_prob = gaussian_log_prob(batch.action, mean, std)
        surrogate = clipped_surrogate_loss(log_prob, batch.log_prob, batch.advantage, self.config.clip_param)
        entropy = gaussian_entropy(std)
        auxiliary = self.auxiliary_loss(self.actor)
        beside = auxiliary + self._weighted_symmetry_loss(batch.observation, mean, averages)
        norm = self._descend(self.actor_optimizer, surrogate - self.config.entropy_coef * entropy + beside)
        self.actor.project_std()
        clipped = ((log_prob.detach() - batch.log_prob).exp() - 1.0).abs() > self.config.clip_param
        averages.add("ppo/kl", kl)
        averages.add("ppo/surrogate_loss", surrogate)
        averages.add("ppo/auxiliary_loss", auxiliary)
        averages.add("ppo/entropy", entropy)
        averages.add("ppo/clip_fraction", clipped)
        averages.add("ppo/std", std)
        averages.add("ppo/grad_norm/actor", norm)
        return kl

    def _weighted_symmetry_loss(self, observation: Tensor, mean: Tensor, averages: Averages) -> Tensor:
        """Of the policy, whose answer to the observation is `mean`; ()."""
        if self.symmetry is None:
            return mean.new_zeros(())
        image = self.actor(self.symmetry.observation(observation))
        loss = symmetry_loss(mean, self.symmetry.action(image), self.actor.std.detach())
        averages.add("ppo/symmetry_loss", loss)
        return self.config.symmetry_weight * loss

    def _critic_step(self, batch: _CriticBatch, averages: Averages) -> None:
        value = self.critic(batch.observation, batch.privileged)
        scale = self.critic.return_std  # the loss counts in standard deviations of the return
        loss = clipped_value_loss(
            value / scale, batch.value / scale, batch.return_ / scale, self.config.value_clip_param
        )
        averages.add("ppo/value_loss", loss)
        averages.add("ppo/grad_norm/critic", self._descend(self.critic_optimizer, loss))

    def _descend(self, optimizer: torch.optim.Optimizer, loss: Tensor) -> Tensor:
        norm = nn.utils.clip_grad_norm_(backward(loss, optimizer), self.config.max_grad_norm)
        optimizer.step()
        return norm

    def _adapt(self, own: Tensor) -> None:
        """Move the rate by this rank's KL, ()."""
        kl = distributed.average(own).item()
        if kl > 2.0 * self.desired_kl:
            self.set_learning_rate(self.learning_rate / RATE_FACTOR)
        elif kl < 0.5 * self.desired_kl:
            self.set_learning_rate(self.learning_rate * RATE_FACTOR)

    def networks(self) -> list[nn.Module]:
        """All that is learned or measured, for ranks to begin with the same."""
        return [self.actor, self.critic]

    def state_dict(self) -> dict[str, Any]:
        """Everything the next update depends on, the adapted rate included (it lives in the optimizer)."""
        return {
            "actor": self.actor.state_dict(),
            "critic": self.critic.state_dict(),
            "actor_optimizer": self.actor_optimizer.state_dict(),
            "critic_optimizer": self.critic_optimizer.state_dict(),
        }

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self.actor.load_state_dict(state["actor"])
        self.critic.load_state_dict(state["critic"])
        self.actor_optimizer.load_state_dict(state["actor_optimizer"])
        self.critic_optimizer.load_state_dict(state["critic_optimizer"])
