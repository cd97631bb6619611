"""Velocity commands and skills, resampled periodically."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from camp.envs.config import CommandConfig


def uniform(interval: Sequence[float], shape: tuple[int, ...], generator: torch.Generator) -> Tensor:
    """Uniform samples in ``interval`` = (low, high) on the generator's device."""
    low, high = interval
    return low + (high - low) * torch.rand(shape, generator=generator, device=generator.device)


def sample_commands(num: int, config: CommandConfig, generator: torch.Generator) -> Tensor:
    """(num, 3) commands vx, vy in m/s and yaw rate in rad/s, base frame.

    Each component is uniform in its range; a fraction of the commands has single components, or all of them, at zero,
    so that straight, sideways, turning and in-place motion all occur.
    """
    ranges = (config.vx_m_s, config.vy_m_s, config.yaw_rate_rad_s)
    command = torch.stack([uniform(interval, (num,), generator) for interval in ranges], dim=1)
    keep = torch.rand(num, 3, generator=generator, device=command.device) >= config.zero_component_fraction
    moving = torch.rand(num, 1, generator=generator, device=command.device) >= config.zero_fraction
    return command * keep * moving


def sample_skills(num: int, num_skills: int, generator: torch.Generator) -> Tensor:
    """(num,) int64 skill labels, uniform."""
    return torch.randint(num_skills, (num,), generator=generator, device=generator.device)
