"""Networks of Table III: actor, critic, skill embedding, conditional discriminator and skill discriminator.

Layers start orthogonal with gain sqrt(2) (which keeps activations' size through ReLU and ELU) and zero bias;
the last layer has its own gain. The generator that draws them lives on the CPU: build first, then move to a
device.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn

from camp.algo.config import ActorConfig, CriticConfig
from camp.algo.normalizer import RunningNormalizer
from camp.common.errors import ConfigError

LARGEST_RETURN = 1e9  # of the running scale; what a task pays is its own affair, so only nonsense is left out
ACTOR_HEAD_GAIN = 0.01  # the first policy holds the default pose (Andrychowicz et al. 2021)
SKILL_HEAD_GAIN = 0.1  # first predictions are short, so the first loss is the embedding's own norm


class MLP(nn.Sequential):
    """Layers that may compute in bfloat16 (`algo.precision`); parameters and answers are float32 in any case."""

    reduced = False

    def forward(self, input: Tensor) -> Tensor:
        with torch.autocast(input.device.type, torch.bfloat16, enabled=self.reduced):
            return super().forward(input).float()


def set_precision(networks: Iterable[nn.Module], precision: str) -> None:
    """Let every `MLP` inside the networks compute in one of PRECISIONS.

    tf32 is torch's setting for the whole process; where a processor has no such unit nothing changes.
    """
    torch.set_float32_matmul_precision("high" if precision == "tf32" else "highest")
    for network in networks:
        for module in network.modules():
            if isinstance(module, MLP):
                module.reduced = precision == "bfloat16"


def mlp(sizes: Sequence[int], activation: type[nn.Module], head_gain: float, generator: torch.Generator) -> MLP:
    """Fully connected; sizes = (inputs, hidden..., outputs), `activation` between layers, none at the end."""
    layers: list[nn.Module] = []
    last = len(sizes) - 2
    for i, (inputs, outputs) in enumerate(pairwise(sizes)):
        layer = nn.Linear(inputs, outputs)
        nn.init.orthogonal_(layer.weight, head_gain if i == last else math.sqrt(2.0), generator=generator)
        nn.init.zeros_(layer.bias)
        layers += [layer] if i == last else [layer, activation()]
    return MLP(*layers)


class GaussianActor(nn.Module):
    """Policy pi(a | o): a normalized-input MLP gives the mean, one state-independent std per action."""

    def __init__(
        self, observation_size: int, action_size: int, config: ActorConfig, generator: torch.Generator
    ) -> None:
        super().__init__()
        self.min_std, self.max_std = config.min_std, config.max_std
        self.normalizer = RunningNormalizer(observation_size)
        sizes = (observation_size, *config.hidden, action_size)
        self.network = mlp(sizes, nn.ELU, ACTOR_HEAD_GAIN, generator)
        self.log_std = nn.Parameter(torch.zeros(action_size), requires_grad=config.learn_std)
        self.set_std(config.initial_std)

    def forward(self, observation: Tensor) -> Tensor:
        """(..., O) raw observation -> (..., A) mean action, the deterministic policy."""
        return self.network(self.normalizer(observation))

    @property
    def std(self) -> Tensor:
        """(A,) exploration standard deviation, action units."""
        return self.log_std.exp()

    @torch.no_grad()
    def set_std(self, value: float) -> None:
        """Gives every action the standard deviation `value` (action units), e.g. on a schedule.

        Raises ConfigError outside [min_std, max_std].
        """
        if not self.min_std <= value <= self.max_std:
            raise ConfigError(
                f"exploration std = {value!r}: choose a value within algo.actor.min_std .. max_std "
                f"({self.min_std} .. {self.max_std})"
            )
        self.log_std.fill_(math.log(value))

    @torch.no_grad()
    def project_std(self) -> None:
        """Moves the std back into its bounds; to be called after each optimizer step.

        Clamping in `forward` instead would cut the gradient outside the bounds and pin the std there for
        good.
        """
        self.log_std.clamp_(math.log(self.min_std), math.log(self.max_std))


class Critic(nn.Module):
    """Asymmetric value function V(o, x), in units of the reward, whose network predicts standardized returns.

    Returns of about 3 per step reach hundreds at a discount of .99, far from what a fresh network puts out;
    the running mean and std of returns carry that scale (PopArt, van Hasselt et al. 2016).
    """

    def __init__(self, input_size: int, config: CriticConfig, generator: torch.Generator) -> None:
        """input_size: O + X."""
        super().__init__()
        self.normalizer = RunningNormalizer(input_size)
        self.returns = RunningNormalizer(1, largest=LARGEST_RETURN)
        self.network = mlp((input_size, *config.hidden, 1), nn.ELU, 1.0, generator)

    def forward(self, observation: Tensor, privileged: Tensor) -> Tensor:
        """(..., O), (..., X) -> (...) value."""
        inputs = self.normalizer(torch.cat([observation, privileged], dim=-1))
        standardized = self.network(inputs).squeeze(-1)
        return standardized * self.return_std + self.returns.mean.to(standardized.dtype)

    @property
    def return_std(self) -> Tensor:
        """(1,) float32 scale of the returns seen, reward units."""
        return self.returns.std.to(torch.float32)

    @torch.no_grad()
    def observe(self, observation: Tensor, privileged: Tensor) -> Tensor:
        """Feeds the input normalizer; (..., O), (..., X). Returns how many rows it left out, ()."""
        return self.normalizer.update(torch.cat([observation, privileged], dim=-1))

    @torch.no_grad()
    def rescale(self, return_: Tensor) -> None:
        """Merges returns (any shape) into the output scale while every predicted value stays what it was.

        The very first call sets the scale without preserving: nothing is learned yet that would be worth it.
        """
        fresh = self.returns.count == 0
        old_mean, old_std = self.returns.mean.clone(), self.returns.std
        self.returns.update(return_.reshape(-1, 1))
        if fresh:
            return
        head = self.network[-1]
        assert isinstance(head, nn.Linear)
        mean, std = self.returns.mean, self.returns.std
        bias = (old_std * head.bias.double() + old_mean - mean) / std
        head.weight.copy_(head.weight.double() * (old_std / std))
        head.bias.copy_(bias)


class SkillEmbedding(nn.Module):
    """z = E(y), eq. (5): one vector per skill, shared by both priors.

    Rows start mutually orthogonal with norm sqrt(Z): equally far apart, and with entries of unit variance
    like the standardized states they are concatenated with, so that the discriminator hears them from the
    first step.
    """

    def __init__(self, num_skills: int, size: int, generator: torch.Generator) -> None:
        """Raises ConfigError where `size` dimensions cannot hold `num_skills` orthogonal vectors."""
        super().__init__()
        if size < num_skills:
            raise ConfigError(
                f"algo.embedding_size = {size}: choose at least the number of skills ({num_skills}), "
                "so that embeddings can start orthogonal"
            )
        self.weight = nn.Parameter(torch.empty(num_skills, size))
        nn.init.orthogonal_(self.weight, gain=math.sqrt(size), generator=generator)

    def forward(self, skill: Tensor) -> Tensor:
        """(B,) int64 label -> (B, Z)."""
        return self.weight[skill]


class ConditionalDiscriminator(nn.Module):
    """D(s_t, s_{t+1} | z) of eq. (3); with embedding_size 0 the plain AMP discriminator D(s_t, s_{t+1})."""

    def __init__(
        self, motion_size: int, embedding_size: int, hidden: Sequence[int], generator: torch.Generator
    ) -> None:
        """motion_size: F * S, numbers of all states judged together."""
        super().__init__()
        network = mlp((motion_size + embedding_size, *hidden, 1), nn.ReLU, 1.0, generator)
        self.trunk, self.head = network[:-1], network[-1]

    def forward(self, state: Tensor, embedding: Tensor | None) -> Tensor:
        """state (B, F, S) standardized, embedding (B, Z) or None -> logit (B,): +1 expert, -1 policy."""
        x = state.flatten(1)
        if embedding is not None:
            x = torch.cat([x, embedding], dim=-1)
        return self.head(self.trunk(x)).squeeze(-1)


class SkillDiscriminator(nn.Module):
    """z_hat = f(s_t, s_{t+1}), eq. (5): which skill does this motion show?"""

    def __init__(
        self, motion_size: int, embedding_size: int, hidden: Sequence[int], generator: torch.Generator
    ) -> None:
        """motion_size: F * S, numbers of all states judged together."""
        super().__init__()
        self.network = mlp((motion_size, *hidden, embedding_size), nn.ReLU, SKILL_HEAD_GAIN, generator)

    def forward(self, state: Tensor) -> Tensor:
        """state (B, F, S) standardized -> (B, Z)."""
        return self.network(state.flatten(1))
