"""What the discriminators see of every robot: its last states, and the transitions that they form."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from camp.envs.measurement import Measurement
from camp.robots.amp_state import discriminator_state_size
from camp.sim.base import select


def discriminator_state(measurement: Measurement, foot_stance: Tensor | None) -> Tensor:
    """(N, S) the paper's state and, where it is given, the ``foot_stance`` (N, 4) of the last control step."""
    state = measurement.amp_state()
    return state if foot_stance is None else torch.cat([state, foot_stance], dim=1)


class MotionHistory:
    """The last states of N robots.

    Args:
        num_envs: N.
        ages: of the states of a transition in control steps, the oldest first and 0 last (``env.transition_ages``).
        foot_stance: whether the states hold it (``env.foot_stance``).
        device: of all tensors.
    """

    def __init__(self, num_envs: int, ages: Sequence[int], foot_stance: bool, device: torch.device):
        self.ages, self.foot_stance = tuple(ages), foot_stance
        size = discriminator_state_size(foot_stance)
        self.states = torch.zeros(num_envs, self.ages[0], size, device=device)  # (N, A, S), the newest last

    @property
    def newest(self) -> Tensor:
        """(N, S)."""
        return self.states[:, -1]

    def move_on(self, measurement: Measurement, foot_stance: Tensor, diverged: Tensor) -> Tensor:
        """Take what was measured after a control step; returns the transitions (N, F, S) that end with it.

        A robot of ``diverged`` (N,) bool has no successor state: it stands still instead.
        """
        reached = discriminator_state(measurement, foot_stance if self.foot_stance else None)
        successor = select(diverged, self.newest, reached)
        history = torch.cat([self.states, successor[:, None]], dim=1)  # (N, A + 1, S)
        self.states = history[:, 1:]
        return torch.stack([history[:, -1 - age] for age in self.ages], dim=1)

    def begin(self, mask: Tensor, states: Tensor) -> None:
        """The robots of ``mask`` (N,) bool begin an episode with the past ``states`` (N, A, S)."""
        self.states = select(mask, states, self.states)
