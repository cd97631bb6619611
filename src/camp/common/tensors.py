"""Constants as tensors, and copies of nested states."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import torch
from torch import Tensor


def constant(values: tuple[float, ...], like: Tensor) -> Tensor:
    """``values`` as a tensor (n,) of the type and device of ``like``; shared, so never write to it.

    One copy per device is kept: making one from Python numbers waits for the device, reading it does not.
    """
    return _constant(values, like.dtype, like.device)


def copied(state: Any, device: torch.device | str) -> Any:
    """``state`` with a copy of every tensor in it on ``device``."""
    if isinstance(state, Tensor):
        return state.to(device, copy=True)
    if isinstance(state, Mapping):
        return {key: copied(value, device) for key, value in state.items()}
    if isinstance(state, (list, tuple)):
        return type(state)(copied(value, device) for value in state)
    return state


@cache
def _constant(values: tuple[float, ...], dtype: torch.dtype, device: torch.device) -> Tensor:
    return torch.tensor(values, dtype=dtype, device=device)
