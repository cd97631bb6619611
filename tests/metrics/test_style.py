"""Warped distances against values worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.metrics.style import dtw_distance, nearest_distance, stride_window

ONE = np.ones(2)


def test_window_begins_at_the_first_touchdown_of_the_first_foot():
    contact = np.zeros((10, 4), dtype=bool)
    contact[:1, 0] = contact[3:6, 0] = True
    state = np.arange(10.0)[:, None]
    assert stride_window(state, contact, 4)[:, 0].tolist() == [3, 4, 5, 6]
    assert stride_window(state, contact, 8)[:, 0].tolist() == [2, 3, 4, 5, 6, 7, 8, 9]  # too late: the last rows
    assert stride_window(state, np.zeros_like(contact), 4)[:, 0].tolist() == [6, 7, 8, 9]
    assert len(stride_window(state, contact, 20)) == 10


@pytest.mark.slow
@pytest.mark.dtw
def test_distance_by_hand():
    first = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    assert dtw_distance(first, first, ONE) == 0.0
    # Every frame .5 and .5 away in both entries: the root mean square is .5.
    shifted = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
    assert dtw_distance(shifted, shifted + 0.5, ONE) == pytest.approx(0.5)
    assert dtw_distance(shifted, shifted + 0.5, 2 * ONE) == pytest.approx(0.25)
    slower = np.repeat(first, 2, axis=0)
    assert dtw_distance(first, slower, ONE) == 0.0
    assert nearest_distance(first, [first + 1.0, slower, first - 3.0], ONE) == 0.0
    assert np.isnan(nearest_distance(first, [], ONE))
