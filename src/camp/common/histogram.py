"""Histograms as metrics: fractions of values in fixed bins, so that those of any two iterations compare."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from camp.common import distributed

BINS = 24
LIMIT = 3.0  # bins lie between -LIMIT and LIMIT; least squares draws logits to +1 and -1
EDGES: tuple[float, ...] = tuple(np.linspace(-LIMIT, LIMIT, BINS + 1).tolist())  # BINS + 1


def fractions(values: Tensor) -> list[float]:
    """Values of any shape -> fraction of all ranks' values in each of the BINS bins, lower edge included; sums to 1.

    The outer bins take what lies beyond them. Every rank calls it, with at least one value on one of them.
    """
    inner = torch.tensor(EDGES[1:-1], dtype=values.dtype, device=values.device)
    index = torch.bucketize(values.detach().flatten(), inner, right=True)
    counts = distributed.total(torch.bincount(index, minlength=BINS)).tolist()
    number = sum(counts)
    return [count / number for count in counts]
