"""When an episode has failed."""

from __future__ import annotations

import torch
from torch import Tensor

from camp.envs.config import TerminationConfig
from camp.envs.measurement import Measurement


def failed(measurement: Measurement, diverged: Tensor, config: TerminationConfig) -> Tensor:
    """(N,) bool: the base or a thigh touches the ground, the trunk tilts too far, or the simulation diverged."""
    touched = (measurement.body_force > config.body_contact_force_n).any(dim=1)
    tilt = torch.acos((-measurement.gravity[:, 2]).clamp(-1.0, 1.0))
    return touched | (tilt > config.tilt_rad) | diverged
