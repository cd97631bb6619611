"""Intervals against the books, and verdicts by them."""

from __future__ import annotations

import numpy as np
import pytest

from camp.metrics.statistics import (
    Interval,
    fraction_interval,
    interquartile_mean,
    mean_interval,
    rare_interval,
    seeds_interval,
)


def test_wilson_by_hand():
    # z = 1.95996: for k = n the lower end is n / (n + z^2).
    found = fraction_interval(13, 13)
    assert found is not None and found.low == pytest.approx(13 / (13 + 1.959964**2)) and found.high == 1.0
    assert fraction_interval(0, 0) is None


def test_no_fall_in_176_is_at_most_two_in_a_hundred():
    found = rare_interval(0, 176)
    assert found is not None and found.high == pytest.approx(1 - 0.025 ** (1 / 176)) and 0.020 < found.high < 0.022


def test_a_target_is_shown_missed_or_neither():
    wide = Interval(0.95, 0.9, 0.98, 100)
    assert wide.verdict(0.95, at_least=True) == "not shown"
    assert wide.verdict(0.9, at_least=True) == "shown" and wide.verdict(0.99, at_least=True) == "missed"
    assert wide.verdict(0.98, at_least=False) == "shown" and wide.verdict(0.8, at_least=False) == "missed"
    assert wide.verdict(0.95, at_least=False) == "not shown"


def test_the_mean_lies_in_its_interval_which_narrows():
    draw = np.random.default_rng(1).exponential(size=400)
    few, many = mean_interval(draw[:40]), mean_interval(draw)
    assert few is not None and many is not None
    assert few.low < few.value < few.high and many.high - many.low < (few.high - few.low) / 2
    assert many.low < 1.0 < many.high and many.n == 400
    assert mean_interval(np.array([])) is None
    assert mean_interval(np.ones(5)) == Interval(1.0, 1.0, 1.0, 5)


def test_the_interquartile_mean_leaves_a_quarter_out_at_both_ends():
    assert interquartile_mean(np.array([[0.0, 1.0, 2.0, 100.0]])) == 1.5


def test_seeds_that_agree_have_no_spread_however_much_skills_differ():
    scores = np.repeat([[0.2, 0.9, 1.0]], 5, axis=0)
    found = seeds_interval(scores)
    assert found.low == pytest.approx(found.value) == pytest.approx(found.high) and found.n == 5
    scores[0] = 0.0
    spread = seeds_interval(scores)
    assert spread.low < spread.value <= spread.high
