"""Which actions an environment takes, and which it can use."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from camp.data import OBSERVATION_LIMIT

# Network outputs beyond what the next observation can show of them: 250 rad of the Go2's joint target.
ACTION_LIMIT = OBSERVATION_LIMIT


def as_action(value: Any, shape: tuple[int, ...], device: torch.device) -> Tensor:
    """``value``, floating-point numbers of that shape, as a float32 tensor on the device.

    Raises ValueError for another type or shape, before anything has changed.
    """
    try:
        action = torch.as_tensor(value)
    except (TypeError, ValueError, RuntimeError) as error:
        raise ValueError(f"action of type {type(value).__name__}: give {_wanted(shape)}") from error
    if not action.is_floating_point():
        raise ValueError(f"action of {action.dtype}: give {_wanted(shape)}")
    if tuple(action.shape) != shape:
        raise ValueError(f"action of shape {tuple(action.shape)}: give {_wanted(shape)}")
    return action.to(device, torch.float32)


def usable(action: Tensor) -> tuple[Tensor, Tensor]:
    """The actions (N, 12), zero in the rows that no motor could follow, and which rows these are, (N,) bool.

    A row is of no use where a number is not finite or beyond ACTION_LIMIT.
    """
    useless = ~(action.abs() <= ACTION_LIMIT).all(dim=1)  # negated, since no comparison with NaN holds
    return action.masked_fill(useless[:, None], 0.0), useless


def _wanted(shape: tuple[int, ...]) -> str:
    return f"floating-point numbers of shape {shape}"
