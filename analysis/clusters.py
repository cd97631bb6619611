"""Do gaits form clusters in the skill discriminator's latent space? Paper, Fig. 3: t-SNE, K-means beside
truth."""

from __future__ import annotations

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
from analysis.style import WIDE, new_figure, skill_colours, style

POINTS_PER_GAIT = 400  # t-SNE of 1600 points takes seconds; more only thickens the clusters


@dataclass(frozen=True)
class Clusters:
    """B transitions in the plane, with two labellings of the same names.

    position: (B, 2), no unit; gait: (B,) true names; cluster: (B,) names that K-means' clusters were matched
    to; rand: adjusted Rand index, 0 for chance, 1 for the same partition; purity: share of points whose
    cluster's most frequent gait is their own.
    """

    position: NDArray[np.floating]
    gait: NDArray[np.str_]
    cluster: NDArray[np.str_]
    rand: float
    purity: float


def sample_transitions(
    clips: list[ClipFeatures], per_gait: int, generator: np.random.Generator
) -> tuple[NDArray[np.floating], NDArray[np.str_]]:
    """Features (B, Z) and gait names (B,): up to `per_gait` transitions of each gait, drawn without
    replacement."""
    features, names = [], []
    for gait in gaits_of(clips):
        pool = np.concatenate([clip.feature for clip in clips if clip.gait == gait])
        chosen = generator.choice(len(pool), size=min(per_gait, len(pool)), replace=False)
        features.append(pool[chosen])
        names += [gait] * len(chosen)
    return np.concatenate(features), np.array(names)


def compute_clusters(feature: NDArray[np.floating], gait: NDArray[np.str_], seed: int) -> Clusters:
    """K-means on standardized features with one cluster per gait, then t-SNE of the same features (paper,
    Sec. IV-A).

    feature: (B, Z); gait: (B,) names. K-means sees all Z dimensions: t-SNE is for the eye only.
    """
    standard = StandardScaler().fit_transform(feature)
    names, truth = np.unique(gait, return_inverse=True)
    # scikit-learn annotates n_init as str only; its documentation allows a count.
    means = KMeans(len(names), n_init=10, random_state=seed)  # pyright: ignore[reportArgumentType]
    index = means.fit_predict(standard)
    counts = np.zeros((len(names), len(names)), dtype=int)  # (cluster, gait)
    np.add.at(counts, (index, truth), 1)
    matched = linear_sum_assignment(-counts)[1]  # the naming of clusters that agrees with most points
    perplexity = min(30.0, (len(standard) - 1) / 3)
    position = TSNE(2, perplexity=perplexity, init="pca", random_state=seed).fit_transform(standard)
    return Clusters(
        position=position,
        gait=gait,
        cluster=names[matched[index]],
        rand=float(adjusted_rand_score(truth, index)),
        purity=float(counts.max(axis=1).sum() / counts.sum()),
    )


def draw_clusters(clusters: Clusters) -> Figure:
    """Ground truth on the left, K-means on the right, the same points and colours."""
    with style():
        figure = new_figure(WIDE)
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        _scatter(left, clusters.position, clusters.gait)
        left.set_title("Gait of the expert clip")
        _scatter(right, clusters.position, clusters.cluster)
        right.set_title(f"K-means: adjusted Rand index {clusters.rand:.2f}, purity {clusters.purity:.0%}")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), markerscale=3)
        figure.suptitle("Skill-discriminator features of expert transitions, t-SNE", fontsize=10)
    return figure


def _scatter(axes: Axes, position: NDArray[np.floating], name: NDArray[np.str_]) -> None:
    for gait, colour in skill_colours(list(dict.fromkeys(name.tolist()))).items():
        chosen = position[name == gait]
        axes.scatter(chosen[:, 0], chosen[:, 1], s=3, c=colour, label=gait, linewidths=0, alpha=0.75)
    axes.set(xticks=[], yticks=[], xlabel="t-SNE 1", ylabel="t-SNE 2")
