"""How long and how often each skill is asked for, where that is not the same for all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import torch
from torch import Tensor

from camp.common.tensors import copied


@dataclass
class SkillSchedule:
    """Set from outside (`camp.training.skill_curriculum`), read by the environment at every step."""

    episode_s: Tensor  # (K,) s until an episode is truncated while this skill is commanded
    weight: Tensor  # (K,) relative frequency with which the skill is drawn, > 0

    @classmethod
    def uniform(cls, num_skills: int, episode_s: float, device: torch.device) -> Self:
        """The same for all skills."""
        return cls(torch.full((num_skills,), episode_s, device=device), torch.ones(num_skills, device=device))

    def episode_steps(self, skill: Tensor, period_s: float) -> Tensor:
        """(N,) control steps until the episodes of robots with these labels (N,) are truncated, at least 1."""
        return (self.episode_s / period_s).round().clamp(min=1.0)[skill]

    def draw(self, num: int, generator: torch.Generator) -> Tensor:
        """(num,) int64 labels."""
        return torch.multinomial(self.weight, num, replacement=True, generator=generator)

    def draw_among(self, possible: Tensor, generator: torch.Generator) -> Tensor:
        """(N,) int64 labels, each of those that are possible (N, K) bool for its robot, at least one."""
        return torch.multinomial(self.weight * possible, 1, generator=generator).squeeze(1)

    def state_dict(self) -> dict[str, Any]:
        return {"episode_s": self.episode_s, "weight": self.weight}

    @classmethod
    def from_state_dict(cls, state: dict[str, Any], device: torch.device) -> Self:
        return cls(**copied(state, device))
