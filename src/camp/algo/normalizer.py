"""Running standardization of network inputs, saved with the model."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from camp.common import distributed

# Rows with a larger number, or one that is not finite, are left out of the statistics, which keep what they have once
# taken in for good. Ten times what the environment lets through, so that none of its rows is left out without a fault.
LARGEST_INPUT = 1e4
VARIANCE_FLOOR = 1e-6  # squared input units; keeps inputs that never vary (an unused one-hot entry) finite


class RunningNormalizer(nn.Module):
    """Standardizes the last dimension by the mean and variance of all usable rows ever given to `update`.

    `forward` never updates: when statistics move is the caller's decision, because a moved normalizer changes
    every network behind it. Before the first `update` it is the identity (up to clipping). Statistics are
    merged exactly (Chan et al. 1979) and kept in float64, so that 1e9 rows neither drift nor cancel.
    """

    mean: Tensor  # (size,) float64
    variance: Tensor  # (size,) float64, population variance
    count: Tensor  # () float64, rows seen

    def __init__(self, size: int, clip: float = 10.0, largest: float = LARGEST_INPUT) -> None:
        """size: inputs; clip: bound on the standardized value, in standard deviations; largest: of a usable input."""
        super().__init__()
        self.clip, self.largest = clip, largest
        self.register_buffer("mean", torch.zeros(size, dtype=torch.float64))
        self.register_buffer("variance", torch.ones(size, dtype=torch.float64))
        self.register_buffer("count", torch.zeros((), dtype=torch.float64))

    @property
    def std(self) -> Tensor:
        """(size,) float64, floored."""
        return (self.variance + VARIANCE_FLOOR).sqrt()

    @torch.no_grad()
    def update(self, x: Tensor) -> Tensor:
        """Merges the rows of x (..., size), those of all ranks together, into the statistics.

        Returns how many of this rank's rows were left out, (): those with a number beyond `largest` or not finite.
        """
        rows = x.reshape(-1, x.shape[-1])
        used = (rows.abs() <= self.largest).all(dim=1)  # no comparison with NaN holds
        mean, variance, count = distributed.moments(rows if used.all() else rows[used])
        total = self.count + count
        fraction = count / total.clamp(min=1.0)  # of the new rows
        delta = mean - self.mean
        self.variance.mul_(1.0 - fraction).add_(variance * fraction + delta.square() * fraction * (1.0 - fraction))
        self.mean.add_(delta * fraction)
        self.count.copy_(total)
        return (~used).sum()

    def forward(self, x: Tensor) -> Tensor:
        """(..., size) -> the same shape and dtype, standardized and clipped."""
        return ((x - self.mean.to(x.dtype)) / self.std.to(x.dtype)).clamp(-self.clip, self.clip)
