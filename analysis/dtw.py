"""DTW distances between gaits at several stride frequencies in the latent skill space (paper, Fig. 4)."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from tslearn.metrics import dtw

from analysis.load import AnalysisError, ClipFeatures, gaits_of
from analysis.style import INK, SQUARE, new_figure, style
from camp.gaits.skills import Skill

DURATION_S = 2.0  # compared of each clip, cut to whole strides
COMMANDS_PER_PAIR = 6  # of those two cells share; each costs a few ms per pair of cells

Cell = tuple[str, float]  # gait, stride frequency in Hz
FeaturesByCommand = dict[tuple[float, ...], NDArray[np.floating]]


@dataclass(frozen=True)
class LatentDistances:
    """labels: C names such as trot_2hz; distance: (C, C) in units of the latent space, nan where no command
    is shared."""

    labels: list[str]
    distance: NDArray[np.floating]


def whole_strides(clip: ClipFeatures) -> NDArray[np.floating]:
    """The clip's features from the front left foot's first touchdown on, over the whole strides in
    DURATION_S.

    DTW pins the first and last frames of two sequences to each other, so both must begin and end at the same
    point of the stride; otherwise a shift of the start would count as a difference between gaits.
    """
    feature = clip.feature[clip.touchdown :]
    available = min(len(feature), round(DURATION_S / clip.period_s))
    strides = np.floor(available * clip.period_s * clip.frequency_hz + 1e-6)
    rows = round(strides / (clip.frequency_hz * clip.period_s)) if strides >= 1 else available
    return feature[:rows]


def compute_distances(clips: list[ClipFeatures]) -> LatentDistances:
    """Mean DTW distance between gait x frequency cells over clips of the same command.

    For each pair of cells the commands both have are matched (at most COMMANDS_PER_PAIR, evenly spread) and
    tslearn's DTW, the root of the summed squared distances along the warping path, is averaged over them.
    Where a cell holds several clips of a command, the first counts. A cell is at distance 0 from itself.
    Raises AnalysisError without clips.
    """
    if not clips:
        raise AnalysisError("no clip of constant command: generate them with `python -m camp.dataset`")
    cells: dict[Cell, FeaturesByCommand] = defaultdict(dict)
    for clip in clips:
        command = tuple(np.round(clip.command, 3).tolist())
        cells[clip.gait, clip.frequency_hz].setdefault(command, whole_strides(clip))
    gaits = gaits_of(clips)
    names = sorted(cells, key=lambda cell: (gaits.index(cell[0]), cell[1]))
    distance = np.full((len(names), len(names)), np.nan)
    for i, first in enumerate(names):
        for j, second in enumerate(names[: i + 1]):
            distance[i, j] = distance[j, i] = _mean_distance(cells[first], cells[second])
    return LatentDistances([Skill(*cell).name for cell in names], distance)


def _mean_distance(first: FeaturesByCommand, second: FeaturesByCommand) -> float:
    shared = sorted(first.keys() & second.keys())
    if not shared:
        return float("nan")
    chosen = np.linspace(0, len(shared) - 1, min(COMMANDS_PER_PAIR, len(shared))).round().astype(int)
    return float(np.mean([dtw(first[shared[i]], second[shared[i]]) for i in chosen]))


def draw_distances(distances: LatentDistances) -> Figure:
    """Heatmap, darker is nearer (as in the paper), every cell with its value."""
    count = len(distances.labels)
    with style():
        figure = new_figure(SQUARE)
        axes = figure.subplots()
        image = axes.imshow(distances.distance, cmap="viridis", vmin=0.0)
        axes.set_xticks(range(count), distances.labels, rotation=45, ha="right", rotation_mode="anchor")
        axes.set_yticks(range(count), distances.labels)
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
        dark = 0.6 * np.nanmax(distances.distance)  # up to here white is the more legible ink
        for (i, j), value in np.ndenumerate(distances.distance):
            text = "-" if np.isnan(value) else f"{value:.3g}"
            axes.text(j, i, text, ha="center", va="center", fontsize=6.5, color="white" if value < dark else INK)
        figure.colorbar(image, ax=axes, shrink=0.8, label="mean DTW distance over matched commands")
        axes.set_title("Distance between gaits in the latent skill space (darker is nearer)")
    return figure
