"""K-means beside truth: agreement is found where it exists and only there."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from analysis.clusters import compute_clusters, compute_partition, draw_clusters, match, sample_transitions
from analysis.style import GAIT_COLOURS, save, skill_shades
from camp.gaits.skills import skill_set
from tests.analysis.synthetic import clip_features


@pytest.fixture(scope="module")
def separable():
    generator = np.random.default_rng(0)
    feature, gait = sample_transitions(clip_features(generator), 30, generator)
    return compute_clusters(feature, gait, seed=0)


def test_sample_is_balanced_over_gaits():
    generator = np.random.default_rng(0)
    feature, gait = sample_transitions(clip_features(generator), 30, generator)
    assert feature.shape == (120, 8)
    assert np.unique(gait, return_counts=True)[1].tolist() == [30, 30, 30, 30]


def test_sample_is_balanced_over_the_skills_of_a_run():
    generator = np.random.default_rng(0)
    skills = skill_set(["trot", "bound"], "gait_frequency", [2.0, 4.0])
    feature, skill = sample_transitions(clip_features(generator), 20, generator, skills)
    assert feature.shape == (80, 8)
    assert dict(zip(*np.unique(skill, return_counts=True), strict=True)) == {s.name: 20 for s in skills}


def test_skills_of_one_gait_have_shades_of_its_colour():
    shades = skill_shades(["trot_2hz", "trot_3hz", "pace_2hz"])
    assert shades["trot_3hz"] == to_rgb(GAIT_COLOURS["trot"]) and shades["pace_2hz"] == to_rgb(GAIT_COLOURS["pace"])
    assert all(pale > full for pale, full in zip(shades["trot_2hz"], shades["trot_3hz"], strict=True))


def test_kmeans_recovers_separable_gaits(separable):
    partition = separable.partition
    scores = partition.scores
    assert scores.accuracy == scores.rand == 1.0 and scores.information == pytest.approx(1.0)
    assert scores.silhouette > 0.3  # six of the eight dimensions are noise
    assert (partition.cluster == partition.skill).all()  # names too, not only the partition
    assert separable.position.shape == (120, 2)


def test_the_same_seed_gives_the_same_picture():
    generator = np.random.default_rng(0)
    feature, gait = sample_transitions(clip_features(generator), 5, generator)
    first, second = (compute_clusters(feature, gait, seed=0) for _ in range(2))
    np.testing.assert_array_equal(first.position, second.position)
    assert (first.partition.cluster == second.partition.cluster).all()


def test_labels_without_structure_score_like_chance():
    generator = np.random.default_rng(1)
    gait = np.repeat(["trot", "pace", "bound", "pronk"], 40)
    partition = compute_partition(generator.normal(size=(160, 8)), gait, seed=0)
    scores = partition.scores
    assert abs(scores.rand) < 0.1 and scores.information < 0.1 and abs(scores.silhouette) < 0.1
    assert scores.accuracy < 0.5


def test_scores_by_hand():
    # Two tight groups; one trot of four lies among the paces: 7 of 8 points share their cluster's gait.
    feature = np.array([[x, 0.0] for x in (0.0, 0.1, 0.2, 9.9, 10.0, 10.1, 10.2, 10.3)])
    gait = np.array(["trot"] * 4 + ["pace"] * 4)
    partition = compute_partition(feature, gait, seed=0)
    assert partition.scores.accuracy == pytest.approx(7 / 8)
    # Pairs together in both: C(3,2) + C(4,2) = 9; in truth 12, in clusters C(3,2) + C(5,2) = 13, of 28:
    # (9 - 12 * 13 / 28) / ((12 + 13) / 2 - 12 * 13 / 28).
    assert partition.scores.rand == pytest.approx((9 - 156 / 28) / (12.5 - 156 / 28))
    assert partition.cluster.tolist() == ["trot"] * 3 + ["pace"] * 5


def test_clusters_are_matched_one_to_one():
    # Both clusters hold label 0 most often, 3 of 4 and 2 of 3 points; one each gives the second cluster label 1.
    cluster, truth = np.array([0, 0, 0, 0, 1, 1, 1]), np.array([0, 0, 0, 1, 0, 0, 1])
    assert match(cluster, truth, 2).tolist() == [0, 1]


def test_the_policys_motion_is_judged_by_the_experts_clusters():
    generator = np.random.default_rng(0)
    feature, gait = sample_transitions(clip_features(generator), 20, generator)
    shown = gait.copy()
    shown[:20] = shown[20]  # the first 20 points were commanded another gait than they show
    clusters = compute_clusters(feature, gait, 0, (feature, shown))
    assert clusters.policy is not None and clusters.policy.accuracy == pytest.approx(0.75)
    assert clusters.position.shape == clusters.policy.position.shape == (80, 2)
    titles = [axes.get_title() for axes in draw_clusters(clusters).axes]
    assert titles[2] == "policy, by command: 75.0% right"


def test_figure_is_written_with_its_scores(separable, tmp_path):
    figure = draw_clusters(separable)
    assert isinstance(figure, Figure)
    assert figure.axes[1].get_title() == "K-means: 100.0% right"
    assert save(figure, tmp_path / "new" / "clusters.png").stat().st_size > 10_000
