"""Measures of ablations against values worked out by hand, and intervals on data whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.measures import (
    answer,
    distinct_gaits,
    gait_counts,
    information,
    mutual_information,
    over_seeds,
    paired_difference,
    pooled,
)
from camp.metrics.statistics import Interval
from tests.analysis.studies import collapsed, obedient


def test_stride_frequencies_are_put_together_and_unknown_gaits_are_none():
    commanded, shown, counts = gait_counts(
        {"trot_2hz": {"trot_2hz": 3, "trot_3hz": 1}, "trot_3hz": {"none": 2}, "pace_2hz": {"gallop": 5}}
    )
    assert commanded == ["trot", "pace"] and shown == ["trot", "pace", "none"]
    assert counts.tolist() == [[4, 0, 2], [0, 0, 5]]


def test_information_of_obedience_is_log2_of_the_commands():
    assert mutual_information(np.eye(4, dtype=int) * 7) == pytest.approx(2.0)
    assert mutual_information(np.eye(2, dtype=int)) == pytest.approx(1.0)


def test_a_wrong_but_reliable_answer_tells_as_much():
    assert mutual_information(np.roll(np.eye(4, dtype=int), 1, axis=1)) == pytest.approx(2.0)


def test_what_does_not_depend_on_the_command_tells_nothing():
    assert mutual_information(gait_counts(collapsed())[2]) == pytest.approx(0.0, abs=1e-12)


def test_information_by_hand():
    # Joint [[3/8, 1/8], [1/8, 3/8]], margins 1/2: 2 * 3/8 * log2(3/2) + 2 * 1/8 * log2(1/2) = .75 * .58496 - .25.
    assert mutual_information(np.array([[3, 1], [1, 3]])) == pytest.approx(0.188722, abs=1e-6)


def test_nothing_walked_is_an_error():
    with pytest.raises(ValueError, match="no walk"):
        mutual_information(np.zeros((2, 3), dtype=int))


def test_distinct_gaits():
    right, single = gait_counts(obedient())[2], gait_counts(collapsed())[2]
    assert distinct_gaits(right, 0.05) == 4 and distinct_gaits(single, 0.05) == 1
    assert distinct_gaits(right, 0.26) == 0  # each is shown in a quarter of all walks
    assert pooled([right, single]).sum() == 160


def test_pairs_are_made_by_seed():
    found = paired_difference({0: 1.0, 1: 2.0, 5: 9.0}, {1: 1.5, 0: 0.5, 7: 0.0})
    assert found == Interval(0.5, 0.5, 0.5, 2)
    assert paired_difference({0: 1.0}, {1: 1.0}) is None


def test_pairing_takes_out_what_the_seed_does_to_both():
    generator = np.random.default_rng(0)
    luck = generator.normal(scale=10.0, size=12)
    full = dict(enumerate(luck))
    arm = dict(enumerate(luck - 1.0 + generator.normal(scale=0.1, size=12)))
    paired = paired_difference(arm, full)
    assert paired is not None and paired.high < -0.8 and paired.low > -1.2
    alone = over_seeds(arm)
    assert alone is not None and alone.high - alone.low > 5.0


@pytest.mark.parametrize(("n", "least"), [(3, 0.6), (5, 0.75), (20, 0.88)])
def test_bootstrap_intervals_cover_the_truth(n, least):
    """Nominally in 95 of 100 cases; fewer seeds cover less, which is why the pages say how many there were."""
    generator = np.random.default_rng(1)
    samples = generator.normal(loc=2.0, size=(120, n))
    found = [over_seeds(dict(enumerate(row))) for row in samples]
    covered = np.mean([interval.low <= 2.0 <= interval.high for interval in found if interval])
    assert least <= covered <= 0.99


def test_answers_need_the_whole_interval():
    assert answer(Interval(1.5, 1.2, 1.8, 3), 1.0) == "Yes"
    assert answer(Interval(0.5, 0.2, 0.8, 3), 1.0) == "No"
    assert answer(Interval(1.1, 0.8, 1.4, 3), 1.0) == "open"
    assert answer(None, 1.0) == "-"


def test_a_walk_that_shows_no_gait_tells_nothing():
    # Trot always shown, pace and bound never, pronk in half: two gaits are told apart in 15 of 40 walks.
    counts = np.array([[10, 0, 0, 0, 0], [0, 0, 0, 0, 10], [0, 0, 0, 0, 10], [0, 0, 0, 5, 5]])
    one_of_two = -(2 / 3 * np.log2(2 / 3) + 1 / 3 * np.log2(1 / 3))
    assert information(counts) == pytest.approx(15 / 40 * one_of_two)
    assert information(np.eye(4, 5, dtype=int)) == pytest.approx(2.0)
    assert information(np.array([[0, 0, 3], [0, 0, 4]])) == 0.0
    with pytest.raises(ValueError, match="no walk"):
        information(np.zeros((2, 3), dtype=int))
