"""What is kept of a robot whose simulation diverged: all that is needed to simulate the step again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor

from camp.robots.robot import Robot
from camp.sim.base import RobotState
from camp.sim.divergence import diverged

ROBOT = "robot"  # the kept robot's number among the N


def judged(robot: Robot, state: RobotState, useless: Tensor, instead: RobotState) -> tuple[RobotState, Tensor]:
    """The states that may be used, and which robots diverged, (N,) bool: by their state or by their action.

    These have no state that is worth anything: that of ``instead``, which the robot begins anew in, takes its place,
    so that nothing that is computed from it can spread.
    """
    mask = diverged(robot, state) | useless
    return state.replaced(mask, instead), mask


def per_robot(state: Mapping[str, Any]) -> dict[str, Tensor]:
    """A simulator's `state_dict` as tensors (N, ...), its delayed targets under ``delays.<name>``."""
    flat: dict[str, Tensor] = {name: value for name, value in state.items() if isinstance(value, Tensor)}
    delays = state["delays"]
    return flat | {"delays.sent": delays["sent"].transpose(0, 1), "delays.late": delays["late"]}


class FirstCase:
    """Keeps one robot's part of what is noted: of the first one that diverged since it was last taken.

    Noting never makes the host wait for an accelerator; taking does.
    """

    def __init__(self, device: torch.device):
        self._taken = torch.zeros((), dtype=torch.bool, device=device)
        self._row = torch.zeros(1, 1, device=device)
        self._shapes: dict[str, torch.Size] = {}

    def note(self, mask: Tensor, parts: Mapping[str, Tensor]) -> None:
        """mask: (N,) bool who diverged; parts: tensors (N, ...) by name, the same names and shapes every time."""
        first = mask.int().argmax(dim=0, keepdim=True)
        rows = {name: part.index_select(0, first) for name, part in parts.items()} | {ROBOT: first[:, None]}
        self._shapes = {name: row.shape[1:] for name, row in rows.items()}
        row = torch.cat([row.reshape(1, -1).double() for row in rows.values()], dim=1)
        fresh = mask.any() & ~self._taken
        self._row = torch.where(fresh, row, self._row if self._row.shape == row.shape else torch.zeros_like(row))
        self._taken = self._taken | fresh

    def take(self) -> dict[str, np.ndarray] | None:
        """The kept robot's parts, float64, and ROBOT, its number; None where nobody diverged since the last call."""
        if not bool(self._taken):
            return None
        self._taken = torch.zeros_like(self._taken)
        sizes = [shape.numel() for shape in self._shapes.values()]
        parts = self._row[0].split(sizes)
        return {
            name: part.reshape(shape).numpy(force=True).copy()
            for (name, shape), part in zip(self._shapes.items(), parts, strict=True)
        }
