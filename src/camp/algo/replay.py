"""Replay buffer of past policy transitions, which keeps a discriminator from forgetting earlier behaviours."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from camp.algo.prior import draw
from camp.data import Transition


class ReplayBuffer:
    """Ring of the last `capacity` transitions with their labels, on one device."""

    def __init__(self, capacity: int, state_size: int, device: torch.device) -> None:
        self._state = torch.zeros(capacity, 2, state_size, device=device)
        self._skill = torch.zeros(capacity, dtype=torch.int64, device=device)
        self._count = 0  # filled rows
        self._next = 0  # row written next

    def __len__(self) -> int:
        return self._count

    def add(self, transition: Transition) -> None:
        """Appends; of more than `capacity` transitions the last ones stay."""
        capacity = self._skill.shape[0]
        transition = transition.take(slice(max(0, len(transition) - capacity), None))
        row = (self._next + torch.arange(len(transition), device=self._skill.device)) % capacity
        self._state[row] = transition.state
        self._skill[row] = transition.skill
        self._next = (self._next + len(transition)) % capacity
        self._count = min(self._count + len(transition), capacity)

    def sample(self, n: int, generator: torch.Generator) -> Transition:
        """n transitions drawn uniformly with replacement."""
        return draw(Transition(self._state[: self._count], self._skill[: self._count]), n, generator)

    def state_dict(self) -> dict[str, Any]:
        filled: dict[str, Tensor] = {
            "state": self._state[: self._count].clone(),
            "skill": self._skill[: self._count].clone(),
        }
        return filled | {"next": self._next}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._count = state["skill"].shape[0]
        self._state[: self._count] = state["state"]
        self._skill[: self._count] = state["skill"]
        self._next = state["next"]
