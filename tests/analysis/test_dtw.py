"""DTW distances between gait x frequency cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from analysis.dtw import LatentDistances, compute_distances, draw_distances, mean_distances, whole_strides
from analysis.load import AnalysisError, ClipFeatures
from analysis.style import save
from tests.analysis.synthetic import PERIOD, clip_features

pytestmark = [pytest.mark.slow, pytest.mark.dtw]


@pytest.fixture(scope="module")
def distances():
    return compute_distances(clip_features(np.random.default_rng(0)))


def test_identical_clips_are_at_distance_zero_and_the_matrix_is_symmetric(distances):
    np.testing.assert_array_equal(np.diag(distances.distance), 0.0)
    np.testing.assert_array_equal(distances.distance, distances.distance.T)


def test_one_gait_at_two_frequencies_is_nearer_than_two_gaits(distances):
    assert distances.labels[:3] == ["trot_2hz", "trot_4hz", "pace_2hz"]
    same = distances.distance[0, 1]
    assert same < 0.5 * distances.distance[0, 2:].min()


def test_distance_by_hand():
    # Constant features (3, 4) apart for 2 s: each of 100 aligned frames costs 5^2, the root of the sum is 50.
    here = ClipFeatures("trot", 2.0, np.zeros(3), np.zeros((199, 2)), 0, PERIOD)
    there = replace(here, gait="pace", feature=np.tile([3.0, 4.0], (199, 1)))
    assert compute_distances([here, there]).distance[0, 1] == pytest.approx(50.0)


def test_warping_by_hand():
    # The same step from 0 to 1, 30 rows later: alike but for their timing. A row of .5 between them has to meet a 0 or
    # a 1 and costs .5^2, of which the root is taken.
    rows = np.arange(199)
    here = ClipFeatures("trot", 2.0, np.zeros(3), (rows >= 30).astype(float)[:, None], 0, PERIOD)
    late = replace(here, gait="pace", feature=(rows >= 60).astype(float)[:, None])
    assert compute_distances([here, late]).distance[0, 1] == 0.0
    late.feature[60] = 0.5
    assert compute_distances([here, late]).distance[0, 1] == pytest.approx(0.5)


def test_where_the_clip_begins_in_its_stride_does_not_count():
    angle = 2 * np.pi * 2.0 * PERIOD * np.arange(199)
    here = ClipFeatures("trot", 2.0, np.zeros(3), np.sin(angle)[:, None], 0, PERIOD)
    # Starts 10 of 25 rows later in the stride, so its front left foot lands after 15 more, where `here`
    # begins.
    later = replace(here, gait="pace", feature=np.sin(angle + angle[10])[:, None], touchdown=15)
    assert compute_distances([here, later]).distance[0, 1] == pytest.approx(0.0, abs=1e-9)
    unaligned = replace(later, touchdown=0)
    assert compute_distances([here, unaligned]).distance[0, 1] > 0.5


def test_strides_are_whole():
    clip = ClipFeatures("trot", 3.0, np.zeros(3), np.zeros((199, 2)), 120, PERIOD)
    # 79 rows remain, 1.58 s: four strides of 1/3 s are 66.7 rows.
    assert len(whole_strides(clip)) == 67


def test_cells_without_a_common_command_stay_empty():
    here = ClipFeatures("trot", 2.0, np.zeros(3), np.zeros((199, 2)), 0, PERIOD)
    there = replace(here, gait="pace", command=np.array([0.5, 0.0, 0.0]))
    distance = compute_distances([here, there]).distance
    assert np.isnan(distance[0, 1]) and distance[0, 0] == 0.0


def test_no_clips_is_named_with_its_remedy():
    with pytest.raises(AnalysisError, match=r"camp\.dataset"):
        compute_distances([])


def test_other_clips_are_the_columns_and_their_diagonal_counts():
    here = ClipFeatures("trot", 2.0, np.zeros(3), np.zeros((199, 2)), 0, PERIOD)
    pace = replace(here, gait="pace", feature=np.full((199, 2), 1.0))
    there = [replace(here, feature=np.tile([3.0, 4.0], (199, 1))), pace]
    found = compute_distances([here, pace], there)
    np.testing.assert_allclose(found.distance, [[50.0, 10 * 2**0.5], [10 * (4.0 + 9.0) ** 0.5, 0.0]])


def test_the_mean_is_over_seeds_and_figure_is_written_with_every_value(tmp_path):
    labels = ["trot_2hz", "pace_2hz"]
    one, two = (LatentDistances(labels, np.array([[0.0, np.nan], [value, 0.0]])) for value in (3.0, 3.4))
    figure = draw_distances({"mean": mean_distances([one, two])})
    assert isinstance(figure, Figure)
    assert [text.get_text() for text in figure.axes[0].texts] == ["", "-", "3.2", ""]
    assert save(figure, tmp_path / "dtw.png").stat().st_size > 10_000
