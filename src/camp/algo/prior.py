"""The interface of motion priors to the training loop, and what both priors share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

import torch
from torch import Tensor, nn

from camp.algo.models import SkillEmbedding
from camp.algo.normalizer import RunningNormalizer
from camp.data import Transition

SCORE_CHUNK = 16384  # transitions scored at once; bounds the activations (64 MiB for 1024 units)


class DemonstrationSource(Protocol):
    """Where expert transitions come from (`camp.motion.clips.sampler.Demonstrations`)."""

    def sample(self, n: int, generator: torch.Generator) -> Transition:
        """n expert transitions, the same number of each skill (+-1)."""
        ...


class Prior(Protocol):
    """A learned judge of motion: rewards the policy and learns beside it, with its own optimizer.

    One that is not wanted is not built (`enabled: false`); one with weight 0 learns and is logged without
    being rewarded.
    """

    name: str  # key of its reward term and of its metrics, `prior/<name>/...`
    weight: float  # in eq. (2)

    def reward(self, transition: Transition) -> Tensor:
        """(B,) reward, without gradient, as judged for the commanded skill `transition.skill`."""
        ...

    def update(
        self, policy: Transition, demonstrations: DemonstrationSource, generator: torch.Generator
    ) -> dict[str, float]:
        """Learns from this iteration's policy transitions and from demonstrations; returns metrics."""
        ...

    def networks(self) -> list[nn.Module]:
        """All that is learned or measured, for ranks to begin with the same."""
        ...

    def state_dict(self) -> dict[str, Any]:
        """What the next update depends on and all ranks have in common."""
        ...

    def load_state_dict(self, state: dict[str, Any]) -> None: ...

    def memory(self) -> dict[str, Any]:
        """What the next update depends on besides, this rank's own."""
        ...

    def load_memory(self, state: dict[str, Any]) -> None: ...


class Discriminator:
    """What both priors are made of and how it is saved: a network on normalized states, its optimizer, and the skills'
    embedding, which they share."""

    network: nn.Module
    embedding: SkillEmbedding
    normalizer: RunningNormalizer
    optimizer: torch.optim.Optimizer

    def networks(self) -> list[nn.Module]:
        return [self.network, self.embedding, self.normalizer]

    def state_dict(self) -> dict[str, Any]:
        """With the embedding, though the other prior may save it too: without it the network's answers mean nothing."""
        return {name: getattr(self, name).state_dict() for name in _SAVED}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        for name in _SAVED:
            getattr(self, name).load_state_dict(state[name])

    def memory(self) -> dict[str, Any]:
        return {}

    def load_memory(self, state: dict[str, Any]) -> None:
        """Nothing, as ``memory`` says."""


_SAVED = ("network", "embedding", "normalizer", "optimizer")


@runtime_checkable
class WithHistograms(Protocol):
    """A prior that shows more than means of its answers."""

    def histograms(
        self, policy: Transition, demonstrations: DemonstrationSource, generator: torch.Generator
    ) -> dict[str, list[float]]:
        """Histograms (camp.common.histogram) of its present answers to policy and expert, by key; it learns nothing."""
        ...


def in_chunks(score: Callable[[Transition], Tensor], transition: Transition) -> Tensor:
    """score(transition) (B, ...) computed piece by piece, without gradient."""
    with torch.no_grad():
        pieces = range(0, max(1, len(transition)), SCORE_CHUNK)  # one at least, also of nothing
        return torch.cat([score(transition.take(slice(i, i + SCORE_CHUNK))) for i in pieces])


def draw(transition: Transition, n: int, generator: torch.Generator) -> Transition:
    """n transitions drawn uniformly with replacement."""
    index = torch.randint(len(transition), (n,), generator=generator, device=generator.device)
    return transition.take(index)
