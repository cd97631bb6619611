"""Matrices side by side: what each arm's priors reward, and what each arm shows for a command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from analysis.style import INK, PAGE, SEQUENTIAL, new_figure, style


@dataclass(frozen=True)
class Panel:
    """One matrix (R, C) with its title and the names of its rows and columns."""

    title: str
    values: NDArray[np.floating]
    rows: list[str]
    columns: list[str]


@dataclass(frozen=True)
class Scale:
    """What the colours of all panels mean. digits: of the numbers in the cells; label: of the colour bar."""

    low: float
    high: float
    label: str
    digits: int = 2


@dataclass(frozen=True)
class Axis:
    """Labels of the rows and of the columns of all panels."""

    rows: str
    columns: str


def draw_panels(panels: Sequence[Panel], scale: Scale, axis: Axis, columns: int = 4) -> Figure:
    """Panels in rows of ``columns``, one colour scale for all, every cell with its value."""
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    with style():
        figure = new_figure((PAGE, 0.35 + rows * 0.98 * PAGE / max(columns, 3)))
        grid = figure.subplots(rows, columns, squeeze=False)
        image = None
        for index, axes in enumerate(grid.ravel()):
            if index >= len(panels):
                axes.set_axis_off()
                continue
            below = index // columns == rows - 1
            image = _draw(axes, panels[index], scale)
            axes.set_xticks(range(len(panels[index].columns)), panels[index].columns if below else [], rotation=90)
            axes.set_yticks(range(len(panels[index].rows)), panels[index].rows if index % columns == 0 else [])
            axes.set_ylabel(axis.rows if index % columns == 0 else "")
            axes.set_xlabel(axis.columns if below else "")
        assert image is not None
        bar = figure.colorbar(image, ax=grid, shrink=0.7, pad=0.01, aspect=30)
        bar.set_label(scale.label)
    return figure


def _draw(axes: Axes, panel: Panel, scale: Scale) -> AxesImage:
    colours = colormaps[SEQUENTIAL].with_extremes(bad="#F2F2F2")
    image = axes.imshow(panel.values, cmap=colours, vmin=scale.low, vmax=scale.high, aspect="auto")
    axes.set_title(panel.title, fontsize=8)
    axes.tick_params(length=0, labelsize=7)
    axes.spines[:].set_visible(False)
    size = 6.5 if max(panel.values.shape) <= 5 else 5.5
    for (i, j), value in np.ndenumerate(panel.values):
        dark = value < scale.low + 0.55 * (scale.high - scale.low)
        text = "" if np.isnan(value) else f"{value:.{scale.digits}f}"
        axes.text(j, i, text, ha="center", va="center", fontsize=size, color="white" if dark else INK)
    return image
