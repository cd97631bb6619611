"""Joint targets that reach the motors late: the latencies of sensors, computation and communication together."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from camp.robots.quadruped import NUM_JOINTS

LONGEST_DELAY = 0.1  # s


class DelayLine:
    """The targets of N robots on their way to the motors, each robot's late by its own number of physics steps.

    Args:
        num_envs: N.
        control_period: s.
        physics_timestep: s.
        device: of all tensors.
    """

    def __init__(self, num_envs: int, control_period: float, physics_timestep: float, device: torch.device):
        self._substeps, self._timestep = round(control_period / physics_timestep), physics_timestep
        self._longest = round(LONGEST_DELAY / physics_timestep)
        kept = 1 + -(-self._longest // self._substeps)
        self._sent = torch.zeros(kept, num_envs, NUM_JOINTS, device=device)  # rad, of the last control steps
        self._late = torch.zeros(num_envs, dtype=torch.int64, device=device)  # physics steps
        self._robots = torch.arange(num_envs, device=device)

    def restart(self, mask: Tensor, joint_target: Tensor, delay: Tensor) -> None:
        """Give the robots of ``mask`` (N,) bool new delays (N,) in s, at most ``LONGEST_DELAY``, and motors that have
        held ``joint_target`` (N, 12) rad."""
        late = (delay / self._timestep).round().long().clamp(0, self._longest)
        self._sent = torch.where(mask[:, None], joint_target.to(self._sent), self._sent)
        self._late = torch.where(mask, late, self._late)

    def idle(self) -> bool:
        """Whether no target is late. Waits for the device."""
        return not bool(self._late.any())

    def send(self, joint_target: Tensor) -> None:
        """The targets (N, 12) rad of a control step, which begins now."""
        self._sent = torch.cat([self._sent[1:], joint_target.to(self._sent)[None]])

    def arrived(self, step: int) -> Tensor:
        """What the motors hold in physics step ``step`` of this control step, (N, 12) rad."""
        age = (self._late - step + self._substeps - 1).clamp(min=0) // self._substeps  # in control steps, rounded up
        return self._sent[len(self._sent) - 1 - age, self._robots]

    def state_dict(self) -> dict[str, Any]:
        return {"sent": self._sent.clone(), "late": self._late.clone()}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._sent, self._late = state["sent"].to(self._sent), state["late"].to(self._late)
