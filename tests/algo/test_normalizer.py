"""Running statistics against torch.var over everything seen."""

from __future__ import annotations

import pytest
import torch

from camp.algo.normalizer import RunningNormalizer
from tests.algo.synthetic import rng


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_merged_chunks_equal_the_statistics_of_all_rows(offset: float):
    chunks = [offset + torch.randn(n, 3, generator=rng(n)) * n for n in (1, 7, 100, 2)]
    normalizer = RunningNormalizer(3)
    for chunk in chunks:
        normalizer.update(chunk)
    rows = torch.cat(chunks).double()
    assert normalizer.count.item() == 110
    torch.testing.assert_close(normalizer.mean, rows.mean(dim=0))
    torch.testing.assert_close(normalizer.variance, rows.var(dim=0, correction=0))


def test_leading_dimensions_are_rows():
    x = torch.randn(4, 5, 2, 3, generator=rng())
    left, right = RunningNormalizer(3), RunningNormalizer(3)
    left.update(x)
    right.update(x.reshape(-1, 3))
    assert torch.equal(left.mean, right.mean) and left.count.item() == 40


def test_output_is_standardized():
    x = 50.0 + 3.0 * torch.randn(10_000, 2, generator=rng())
    normalizer = RunningNormalizer(2)
    normalizer.update(x)
    y = normalizer(x)
    assert y.dtype == torch.float32
    torch.testing.assert_close(y.mean(dim=0), torch.zeros(2), atol=1e-4, rtol=0)
    torch.testing.assert_close(y.std(dim=0), torch.ones(2), atol=1e-3, rtol=0)


def test_forward_never_updates_and_starts_as_identity():
    normalizer = RunningNormalizer(2)
    x = torch.tensor([[1.0, -2.0]])
    torch.testing.assert_close(normalizer(x), x)
    assert normalizer.count.item() == 0


def test_constant_input_stays_finite_and_outliers_are_clipped():
    normalizer = RunningNormalizer(2, clip=5.0)
    normalizer.update(torch.tensor([[1.0, 0.0], [1.0, 2.0]]))
    y = normalizer(torch.tensor([[1.0, 1000.0], [2.0, -1000.0]]))
    assert y.tolist() == [[0.0, 5.0], [5.0, -5.0]]


@pytest.mark.parametrize("huge", [1e8, float("nan"), float("inf"), -1e5])
def test_an_impossible_row_does_not_move_the_statistics(huge: float):
    rows = 5.0 * torch.randn(1000, 3, generator=rng())
    clean, fed = RunningNormalizer(3), RunningNormalizer(3)
    assert clean.update(rows).item() == 0
    assert fed.update(torch.cat([rows, torch.tensor([[0.0, huge, 0.0]])])).item() == 1
    assert torch.equal(fed.mean, clean.mean) and torch.equal(fed.variance, clean.variance)
    assert fed.update(torch.full((4, 3), huge)).item() == 4 and torch.equal(fed.std, clean.std)


def test_no_rows_change_nothing():
    normalizer = RunningNormalizer(2)
    normalizer.update(torch.zeros(0, 2))
    assert normalizer.variance.tolist() == [1.0, 1.0] and normalizer.count.item() == 0
