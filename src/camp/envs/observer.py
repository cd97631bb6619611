"""What policy and critic observe: their entries, sensor noise, and the policy's last control steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from camp.data import OBSERVATION_LIMIT
from camp.envs import observations
from camp.envs.commands import uniform
from camp.envs.config import EnvConfig
from camp.envs.situation import Situation


@dataclass
class Observed:
    """What is observed of N robots at one moment."""

    observation: Tensor  # (N, O) with sensor noise
    privileged: Tensor  # (N, X)


class Observer:
    """Observes situations. An observation is a row of frames, each one control step's, the newest last.

    Args:
        config: conf/env.
        num_skills: K.
        generator: for the noise, on the device of the situations.
    """

    def __init__(self, config: EnvConfig, num_skills: int, generator: torch.Generator):
        self.actor_entries = observations.entries_of(config.observation.policy, num_skills)
        self.privileged_entries = observations.entries_of(config.observation.critic, num_skills)
        self.sizes = observations.sizes(config.observation, num_skills)  # O, X
        self._frame = observations.size(self.actor_entries)
        self._generator = generator
        width = observations.noise_width(self.actor_entries, config.noise).to(generator.device)
        self._noise = width if config.noise.enabled else None

    def frame(self, situation: Situation, noise: float) -> Observed:
        """One control step's frame (N, F) of the policy's observation, and the critic's privileged part without noise.

        noise: share of the configured sensor noise, in [0, 1].
        """
        frame = observations.observe(self.actor_entries, situation)
        if self._noise is not None:
            frame += noise * self._noise * uniform((-1.0, 1.0), tuple(frame.shape), self._generator)
        privileged = observations.observe(self.privileged_entries, situation)
        return Observed(_bounded(frame), _bounded(privileged))

    def first(self, frames: Sequence[Tensor]) -> Tensor:
        """(N, O) at a start, of the last H control steps' frames (N, F), oldest first."""
        return torch.cat(list(frames), dim=1)

    def next(self, observation: Tensor, frame: Tensor) -> Tensor:
        """(N, O) one control step later."""
        return torch.cat([observation[:, self._frame :], frame], dim=1)

    def corrected(self, observation: Tensor, frame: Tensor) -> Tensor:
        """(N, O) with another newest frame."""
        return torch.cat([observation[:, : -self._frame], frame], dim=1)


def _bounded(value: Tensor) -> Tensor:
    return value.nan_to_num(0.0).clamp_(-OBSERVATION_LIMIT, OBSERVATION_LIMIT)
