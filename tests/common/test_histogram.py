"""Histograms in fixed bins: what counts where, and that ranks are counted together."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from camp.common import distributed
from camp.common.histogram import BINS, EDGES, fractions
from tests.ranks import in_ranks


def test_shares_are_those_of_numpy_and_the_outer_bins_take_the_rest():
    values = 1.5 * torch.randn(40, 50, generator=torch.Generator().manual_seed(0))
    assert (values.abs() > 3.0).any()
    counted, edges = np.histogram(values.clamp(-3.0, 3.0).numpy(), bins=24, range=(-3.0, 3.0))
    assert fractions(values) == pytest.approx((counted / 2000).tolist())
    assert pytest.approx(edges.tolist()) == EDGES
    assert sum(fractions(values)) == pytest.approx(1.0)


def test_a_value_on_an_edge_belongs_above_it():
    found = fractions(torch.tensor([-3.0, -2.75, 0.0, 3.0]))
    assert len(found) == BINS
    assert {bin_: fraction for bin_, fraction in enumerate(found) if fraction} == {0: 0.25, 1: 0.25, 12: 0.25, 23: 0.25}


def one_value_or_three() -> list[float]:
    return fractions(torch.full((3, 1), -9.0) if distributed.is_first() else torch.tensor([9.0]))


@pytest.mark.slow
def test_all_ranks_values_count_the_same_on_every_rank(tmp_path):
    assert in_ranks(one_value_or_three, tmp_path) == [[0.75, *[0.0] * 22, 0.25]] * 2
