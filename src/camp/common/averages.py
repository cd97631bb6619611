"""Means of metrics over the minibatches of one update and over all ranks."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn import functional

from camp.common import distributed


class Averages:
    """Sums on the device and transfers once, so that logging never makes the accelerator wait."""

    def __init__(self) -> None:
        self._sum: dict[str, Tensor] = {}
        self._count: dict[str, Tensor] = {}

    def add(self, name: str, values: Tensor, where: Tensor | None = None) -> None:
        """Takes values of any shape; each element counts once, or those alone at which ``where`` (bool) holds."""
        values = values.detach().to(torch.float32)
        if where is None:
            self._add(name, values.sum(), torch.full((), float(values.numel()), device=values.device))
        else:
            self._add(name, values.masked_fill(~where, 0.0).sum(), where.sum(dtype=torch.float32))

    def add_per_skill(self, name: str, values: Tensor, skill: Tensor, skills: Sequence[str]) -> None:
        """Takes values (B,) with labels (B,) and keeps one mean per skill under `name/<skill>`."""
        member = functional.one_hot(skill, len(skills)).to(torch.float32)  # (B, K)
        sums, counts = values.detach().to(torch.float32) @ member, member.sum(dim=0)
        for i, label in enumerate(skills):
            self._add(f"{name}/{label}", sums[i], counts[i])

    def _add(self, name: str, total: Tensor, count: Tensor) -> None:
        self._sum[name] = self._sum[name] + total if name in self._sum else total
        self._count[name] = self._count[name] + count if name in self._count else count

    def result(self) -> dict[str, float]:
        """Mean per name over all ranks, which have added the same names; those without any values are left out."""
        if not self._sum:
            return {}
        rows = torch.stack([torch.stack(list(self._sum.values())), torch.stack(list(self._count.values()))])
        sums, counts = distributed.total(rows).tolist()
        return {name: s / n for name, s, n in zip(self._sum, sums, counts, strict=True) if n > 0}
