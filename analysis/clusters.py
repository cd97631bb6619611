"""Skill clusters in the skill discriminator's latent space: t-SNE, K-means beside ground truth (paper, Fig. 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from sklearn.cluster import KMeans
from sklearn.manifold import TSNE
from sklearn.metrics import adjusted_rand_score, normalized_mutual_info_score, silhouette_score
from sklearn.preprocessing import StandardScaler

from analysis.load import ClipFeatures, gaits_of
from analysis.style import PAGE, new_figure, skill_shades, style
from camp.gaits.skills import Skill

POINTS_PER_SKILL = 200  # t-SNE of 1600 points takes seconds; more only thickens the clusters
LEGEND: dict[str, Any] = {"fontsize": 7.5, "handletextpad": 0.1, "columnspacing": 0.8, "markerscale": 3}
Floats = NDArray[np.floating]


@dataclass(frozen=True)
class Scores:
    """How well K-means' clusters are the skills.

    accuracy: fraction of points in the cluster that was matched to their skill; rand: adjusted Rand index, 0 for
    chance, 1 for the same partition; information: normalized mutual information, 0 to 1; silhouette: of the true
    skills, -1 to 1, how much nearer a point is to its own skill than to the next.
    """

    accuracy: float
    rand: float
    information: float
    silhouette: float

    def __str__(self) -> str:
        return (
            f"accuracy {self.accuracy:.1%}, ARI {self.rand:.2f}, NMI {self.information:.2f}, "
            f"silhouette {self.silhouette:.2f}"
        )


@dataclass(frozen=True)
class Partition:
    """K-means' clusters of B transitions beside their skills.

    skill: (B,) true names; cluster: (B,) names that K-means' clusters were matched to.
    """

    skill: NDArray[np.str_]
    cluster: NDArray[np.str_]
    scores: Scores


@dataclass(frozen=True)
class PolicyPoints:
    """What a policy shows, P transitions in the same plane. position: (P, 2); commanded: (P,) names;
    accuracy: fraction whose nearest cluster was matched to the commanded skill."""

    position: Floats
    commanded: NDArray[np.str_]
    accuracy: float


@dataclass(frozen=True)
class Clusters:
    """B transitions of the expert in the plane, with two labellings, and the policy's. position: (B, 2), no unit."""

    position: Floats
    partition: Partition
    policy: PolicyPoints | None = None


def sample_transitions(
    clips: list[ClipFeatures],
    per_skill: int,
    generator: np.random.Generator,
    skills: Sequence[Skill] | None = None,
) -> tuple[Floats, NDArray[np.str_]]:
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


def compute_clusters(
    feature: Floats, skill: NDArray[np.str_], seed: int, policy: tuple[Floats, NDArray[np.str_]] | None = None
) -> Clusters:
    """K-means and t-SNE of the same standardized features (paper, Sec. IV-A).

    feature: (B, Z) of the expert; skill: (B,) names; policy: features (P, Z) and commanded skills (P,), in the units of
    the expert's standard deviations. K-means uses all Z dimensions; t-SNE serves the picture only.
    """
    scaler = StandardScaler().fit(feature)
    standard = np.asarray(scaler.transform(feature))
    means, partition = _partition(standard, skill, seed)
    every = standard if policy is None else np.concatenate([standard, np.asarray(scaler.transform(policy[0]))])
    perplexity = min(30.0, (len(every) - 1) / 3)
    position = TSNE(2, perplexity=perplexity, init="pca", random_state=seed).fit_transform(every)
    expert, rest = position[: len(standard)], position[len(standard) :]
    if policy is None:
        return Clusters(expert, partition)
    cluster = _names(np.asarray(means.labels_), partition)[means.predict(every[len(standard) :])]
    points = PolicyPoints(rest, policy[1], float((cluster == policy[1]).mean()))
    return Clusters(expert, partition, points)


def compute_partition(feature: Floats, skill: NDArray[np.str_], seed: int) -> Partition:
    """K-means on standardized features (B, Z) with one cluster for each of the skills' names (B,)."""
    return _partition(np.asarray(StandardScaler().fit_transform(feature)), skill, seed)[1]


def _partition(standard: Floats, skill: NDArray[np.str_], seed: int) -> tuple[KMeans, Partition]:
    names, truth = np.unique(skill, return_inverse=True)
    # scikit-learn annotates n_init as str only; its documentation allows a count.
    means = KMeans(len(names), n_init=10, random_state=seed)  # pyright: ignore[reportArgumentType]
    index = means.fit_predict(standard)
    matched = match(index, truth, len(names))
    scores = Scores(
        accuracy=float((matched[index] == truth).mean()),
        rand=float(adjusted_rand_score(truth, index)),
        information=float(normalized_mutual_info_score(truth, index)),
        silhouette=float(silhouette_score(standard, truth)),
    )
    return means, Partition(skill, names[matched[index]], scores)


def match(cluster: NDArray[np.integer], truth: NDArray[np.integer], count: int) -> NDArray[np.integer]:
    """The label (count,) that each cluster is called by, one each, so that most points (B,) agree."""
    counts = np.zeros((count, count), dtype=int)  # (cluster, label)
    np.add.at(counts, (cluster, truth), 1)
    return linear_sum_assignment(-counts)[1]


def _names(index: NDArray[np.integer], partition: Partition) -> NDArray[np.str_]:
    """The name of each cluster, of which every one has a point."""
    _, first = np.unique(index, return_index=True)
    return partition.cluster[first]


def draw_clusters(clusters: Clusters) -> Figure:
    """Ground truth, K-means, and the policy's own motion; the same plane and colours."""
    partition, policy = clusters.partition, clusters.policy
    panels = [("expert: true skill", clusters.position, partition.skill)]
    panels.append((f"K-means: {partition.scores.accuracy:.1%} right", clusters.position, partition.cluster))
    if policy is not None:
        panels.append((f"policy, by command: {policy.accuracy:.1%} right", policy.position, policy.commanded))
    with style():
        figure = new_figure((PAGE, 3.1))
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True)
        for axis, (title, position, names) in zip(axes, panels, strict=True):
            if axis is axes[-1] and policy is not None:
                axis.scatter(*clusters.position.T, s=3, color="#E8E8E8", linewidths=0)
            _scatter(axis, position, names)
            axis.set_title(title, fontsize=8.0)
        axes[0].set_ylabel("t-SNE 2")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 8), **LEGEND)
        scores = partition.scores
        figure.suptitle(
            f"Features of motion not seen in training; K-means: ARI {scores.rand:.2f}, NMI {scores.information:.2f}; "
            f"true skills: silhouette {scores.silhouette:.2f}",
            fontsize=8.5,
        )
    return figure


def _scatter(axes: Axes, position: Floats, name: NDArray[np.str_]) -> None:
    for skill, colour in skill_shades(list(dict.fromkeys(name.tolist()))).items():
        chosen = position[name == skill]
        axes.scatter(chosen[:, 0], chosen[:, 1], s=4, color=colour, label=skill, linewidths=0, alpha=0.8)
    axes.set(xticks=[], yticks=[], xlabel="t-SNE 1")
