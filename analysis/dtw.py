"""DTW distances between gaits at several stride frequencies in the latent skill space (paper, Fig. 4)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from tslearn.metrics import dtw

from analysis.load import AnalysisError, ClipFeatures, in_order
from analysis.style import INK, PAGE, SEQUENTIAL, SQUARE, new_figure, style
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


def compute_distances(clips: list[ClipFeatures], others: list[ClipFeatures] | None = None) -> LatentDistances:
    """Mean DTW distance between gait x frequency cells over clips of the same command.

    For each pair of cells the commands both have are matched (at most COMMANDS_PER_PAIR, evenly spread) and
    tslearn's DTW, the root of the summed squared distances along the warping path, is averaged over them.
    Where a cell holds several clips of a command, the first counts. A cell is at distance 0 from itself.
    others: whose cells are the columns, such as the expert's beside a policy's; the clips' own where none are given.
    Raises AnalysisError without clips.
    """
    if not clips or others == []:
        raise AnalysisError("no clip of constant command: generate them with `python -m camp.dataset`")
    cells = _cells(clips)
    columns = cells if others is None else _cells(others)
    names = [name for name in _ordered(cells) if name in columns]
    distance = np.full((len(names), len(names)), np.nan)
    for i, first in enumerate(names):
        for j, second in enumerate(names):
            if others is None and j > i:
                continue
            distance[i, j] = _mean_distance(cells[first], columns[second])
            if others is None:
                distance[j, i] = distance[i, j]
    return LatentDistances([Skill(*cell).name for cell in names], distance)


def _cells(clips: list[ClipFeatures]) -> dict[Cell, FeaturesByCommand]:
    cells: dict[Cell, FeaturesByCommand] = defaultdict(dict)
    for clip in clips:
        command = tuple((np.round(np.asarray(clip.command, dtype=float), 3) + 0.0).tolist())
        cells[clip.gait, clip.frequency_hz].setdefault(command, whole_strides(clip))
    return cells


def _ordered(cells: Mapping[Cell, FeaturesByCommand]) -> list[Cell]:
    gaits = in_order([gait for gait, _ in cells])
    return sorted(cells, key=lambda cell: (gaits.index(cell[0]), cell[1]))


def _mean_distance(first: FeaturesByCommand, second: FeaturesByCommand) -> float:
    shared = sorted(first.keys() & second.keys())
    if not shared:
        return float("nan")
    chosen = np.linspace(0, len(shared) - 1, min(COMMANDS_PER_PAIR, len(shared))).round().astype(int)
    return float(np.mean([dtw(first[shared[i]], second[shared[i]]) for i in chosen]))


def mean_distances(several: Sequence[LatentDistances]) -> LatentDistances:
    """The mean over seeds of distances between the same cells."""
    return LatentDistances(several[0].labels, np.mean([one.distance for one in several], axis=0))


def draw_distances(panels: Mapping[str, LatentDistances], rows: Sequence[str] = ()) -> Figure:
    """Heatmaps side by side by title, darker is nearer (as in the paper), every cell off the diagonal with its value.

    The colours of each end at its least and greatest value off the diagonal, which is 0 by definition. rows: whose
    cells the rows of each panel are, where they are not the columns'.
    """
    with style():
        figure = new_figure((PAGE, 3.2) if len(panels) > 1 else SQUARE)
        grid = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, (title, distances), whose in zip(grid, panels.items(), rows or [""] * len(panels), strict=True):
            _draw_map(axes, distances)
            axes.set_title(title, fontsize=8.5)
            axes.set_ylabel(whose)
    return figure


def _draw_map(axes: Axes, distances: LatentDistances) -> None:
    count = len(distances.labels)
    itself = np.eye(count, dtype=bool) & (distances.distance == 0.0)
    shown = np.where(itself, np.nan, distances.distance)
    colours = colormaps[SEQUENTIAL].with_extremes(bad="white")
    low, high = (np.nanmin(shown), np.nanmax(shown)) if np.isfinite(shown).any() else (0.0, 1.0)
    image = axes.imshow(shown, cmap=colours, vmin=low, vmax=high)
    axes.set_xticks(range(count), distances.labels, rotation=90)
    axes.set_yticks(range(count), distances.labels)
    axes.tick_params(length=0, labelsize=6.5)
    axes.spines[:].set_visible(False)
    dark = low + 0.55 * (high - low)  # up to here white is the more legible ink
    for (i, j), value in np.ndenumerate(shown):
        text = "" if itself[i, j] else "-" if np.isnan(value) else f"{value:.{0 if value >= 10 else 1}f}"
        axes.text(j, i, text, ha="center", va="center", fontsize=5.5, color="white" if value < dark else INK)
    for edge in range(1, count):  # a line where another gait begins
        if distances.labels[edge].split("_")[0] != distances.labels[edge - 1].split("_")[0]:
            axes.axhline(edge - 0.5, color="white", linewidth=1.2)
            axes.axvline(edge - 0.5, color="white", linewidth=1.2)
    bar = axes.figure.colorbar(image, ax=axes, shrink=0.8, pad=0.02)
    bar.set_label("DTW distance", fontsize=7)
    bar.ax.tick_params(labelsize=6.5)
