"""Skill clusters in the skill discriminator's latent space: t-SNE, K-means beside ground truth (paper, Fig. 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from sklearn.cluster import KMeans
from sklearn.manifold import TSNE
from sklearn.metrics import adjusted_rand_score
from sklearn.preprocessing import StandardScaler

from analysis.load import ClipFeatures, gaits_of
from analysis.style import WIDE, new_figure, skill_shades, style
from camp.gaits.skills import Skill

POINTS_PER_SKILL = 200  # t-SNE of 1600 points takes seconds; more only thickens the clusters


@dataclass(frozen=True)
class Partition:
    """K-means' clusters of B transitions beside their skills.

    skill: (B,) true names; cluster: (B,) names that K-means' clusters were matched to; rand: adjusted Rand index,
    0 for chance, 1 for the same partition; purity: fraction of points whose cluster's most frequent skill is their own.
    """

    skill: NDArray[np.str_]
    cluster: NDArray[np.str_]
    rand: float
    purity: float


@dataclass(frozen=True)
class Clusters:
    """B transitions in the plane, with two labellings. position: (B, 2), no unit."""

    position: NDArray[np.floating]
    partition: Partition


def sample_transitions(
    clips: list[ClipFeatures],
    per_skill: int,
    generator: np.random.Generator,
    skills: Sequence[Skill] | None = None,
) -> tuple[NDArray[np.floating], NDArray[np.str_]]:
    """Features (B, Z) and skill names (B,): up to `per_skill` transitions of each skill, drawn without replacement.

    skills: each with a clip or more; the gaits that occur where none are given.
    """
    features, names = [], []
    for skill in skills or [Skill(gait) for gait in gaits_of(clips)]:
        pool = np.concatenate([clip.feature for clip in clips if skill.includes(clip.gait, clip.frequency_hz)])
        chosen = generator.choice(len(pool), size=min(per_skill, len(pool)), replace=False)
        features.append(pool[chosen])
        names += [skill.name] * len(chosen)
    return np.concatenate(features), np.array(names)


def compute_clusters(feature: NDArray[np.floating], skill: NDArray[np.str_], seed: int) -> Clusters:
    """K-means and t-SNE of the same standardized features (paper, Sec. IV-A).

    feature: (B, Z); skill: (B,) names. K-means uses all Z dimensions; t-SNE serves the picture only.
    """
    standard = StandardScaler().fit_transform(feature)
    perplexity = min(30.0, (len(standard) - 1) / 3)
    position = TSNE(2, perplexity=perplexity, init="pca", random_state=seed).fit_transform(standard)
    return Clusters(position, compute_partition(feature, skill, seed))


def compute_partition(feature: NDArray[np.floating], skill: NDArray[np.str_], seed: int) -> Partition:
    """K-means on standardized features (B, Z) with one cluster for each of the skills' names (B,)."""
    standard = StandardScaler().fit_transform(feature)
    names, truth = np.unique(skill, return_inverse=True)
    # scikit-learn annotates n_init as str only; its documentation allows a count.
    means = KMeans(len(names), n_init=10, random_state=seed)  # pyright: ignore[reportArgumentType]
    index = means.fit_predict(standard)
    counts = np.zeros((len(names), len(names)), dtype=int)  # (cluster, skill)
    np.add.at(counts, (index, truth), 1)
    matched = linear_sum_assignment(-counts)[1]  # the naming of clusters that agrees with most points
    return Partition(
        skill=skill,
        cluster=names[matched[index]],
        rand=float(adjusted_rand_score(truth, index)),
        purity=float(counts.max(axis=1).sum() / counts.sum()),
    )


def draw_clusters(clusters: Clusters) -> Figure:
    """Ground truth on the left, K-means on the right, the same points and colours."""
    partition = clusters.partition
    with style():
        figure = new_figure(WIDE)
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        _scatter(left, clusters.position, partition.skill)
        left.set_title("Skill of the expert clip")
        _scatter(right, clusters.position, partition.cluster)
        right.set_title(f"K-means: adjusted Rand index {partition.rand:.2f}, purity {partition.purity:.0%}")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4), markerscale=3)
        figure.suptitle("Skill-discriminator features of expert transitions, t-SNE", fontsize=10)
    return figure


def _scatter(axes: Axes, position: NDArray[np.floating], name: NDArray[np.str_]) -> None:
    for skill, colour in skill_shades(list(dict.fromkeys(name.tolist()))).items():
        chosen = position[name == skill]
        axes.scatter(chosen[:, 0], chosen[:, 1], s=3, color=colour, label=skill, linewidths=0, alpha=0.75)
    axes.set(xticks=[], yticks=[], xlabel="t-SNE 1", ylabel="t-SNE 2")
