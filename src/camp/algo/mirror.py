"""The left-right symmetry of the robot, as tensors see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from camp.robots.mirror import Mirror


class Reflection:
    """The mirror image of numbers that stand side by side in the last dimension."""

    def __init__(self, mirrors: Sequence[Mirror], device: torch.device) -> None:
        """mirrors: of one entry after the other."""
        order: list[int] = []
        for mirror in mirrors:
            order += [len(order) + i for i in mirror.order]
        self._order = torch.tensor(order, dtype=torch.int64, device=device)
        self._sign = torch.tensor([sign for mirror in mirrors for sign in mirror.sign], device=device)

    def __call__(self, values: Tensor) -> Tensor:
        """(..., size) -> (..., size)."""
        return values[..., self._order] * self._sign


@dataclass(frozen=True)
class Symmetry:
    """How what the policy sees and does looks in a mirror."""

    observation: Reflection
    action: Reflection
