"""Times of switches against values worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.metrics.switching import fraction_within, peak_in_windows, quantile_of_switches

SECONDS = np.array([0.2, 1.0, np.nan, 1.02])


def test_fraction_within_counts_never_as_no():
    assert fraction_within(SECONDS, 1.0) == pytest.approx(0.5)
    assert fraction_within(SECONDS, 2.0) == pytest.approx(0.75)
    assert fraction_within(np.array([50 * 0.02]), 1.0) == 1.0
    assert fraction_within(np.array([]), 1.0) is None


def test_quantiles_treat_never_as_the_longest():
    assert quantile_of_switches(SECONDS, 0.5) == 1.0
    assert quantile_of_switches(SECONDS, 0.75) == 1.02
    assert quantile_of_switches(SECONDS, 0.9) is None
    assert quantile_of_switches(np.array([]), 0.5) is None


def test_peak_in_windows():
    value = np.array([[1.0, 5.0, 2.0, 0.0], [9.0, 3.0, 4.0, 8.0]])
    assert peak_in_windows(value, np.array([[0, 0], [0, 2], [1, 1]]), 2).tolist() == [5.0, 2.0, 4.0]
    assert peak_in_windows(value, np.empty((0, 2), dtype=int), 2).shape == (0,)
