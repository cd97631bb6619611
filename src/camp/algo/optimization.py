"""Gradients, averaged over all ranks."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from camp.common import distributed


def backward(loss: Tensor, optimizer: torch.optim.Optimizer) -> list[nn.Parameter]:
    """Fills the gradients of the optimizer's parameters with those of the mean of all ranks' losses (); returns the
    parameters."""
    optimizer.zero_grad(set_to_none=True)
    loss.backward()
    parameters = [parameter for group in optimizer.param_groups for parameter in group["params"]]
    distributed.average_gradients(parameters)
    return parameters
