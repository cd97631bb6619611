"""A study drawn: learning curves, confusion matrices and the measures of every arm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter
from numpy.typing import NDArray

from analysis.arms import title_of
from analysis.matrices import Axis, Panel, Scale, draw_panels
from analysis.measures import gait_counts, over_seeds, pooled
from analysis.study_results import RunResult, StudyResult
from analysis.style import COLUMN, GREY, GRID, INK, PAGE, new_figure, style
from analysis.tables import GAITS_SHOWN, INFORMATION, by_seed, measures
from camp.metrics.statistics import interquartile_mean, seeds_interval

# Okabe and Ito, told apart by dashes too.
LOOKS = (
    *((INK, "-"), ("#0072B2", "-"), ("#D55E00", "-"), ("#009E73", "-")),
    *(("#CC79A7", (0, (4, 1.5))), ("#E69F00", (0, (4, 1.5))), (GREY, (0, (1, 1.2))), ("#56B4E9", (0, (1, 1.2)))),
)
FEWEST_FOR_BAND = 3


def curve_of(runs: Sequence[RunResult]) -> tuple[NDArray, NDArray, NDArray, NDArray] | None:
    """Steps in millions, interquartile mean over seeds (of three their mean), and its interval, each (P,).

    None without a curve; no interval of fewer than FEWEST_FOR_BAND seeds.
    """
    known = [run for run in runs if len(run.curve_steps) > 1]
    if not known:
        return None
    end = min(run.curve_steps[-1] for run in known)
    steps = np.linspace(max(run.curve_steps[0] for run in known), end, len(known[0].curve_steps))
    values = np.array([np.interp(steps, run.curve_steps, run.curve_accuracy) for run in known])  # (S, P)
    middle = np.array([interquartile_mean(column) for column in values.T])
    if len(known) < FEWEST_FOR_BAND:
        return steps, middle, middle, middle
    bands = [seeds_interval(column[:, None]) for column in values.T]
    return steps, middle, np.array([band.low for band in bands]), np.array([band.high for band in bands])


def draw_learning(result: StudyResult) -> Figure:
    """Accuracy of the gaits while training, by arm."""
    with style():
        figure = new_figure((COLUMN, 3.0))
        axes = figure.subplots()
        for arm, (colour, dashes) in zip(result.arms, LOOKS * 2, strict=False):
            found = curve_of(result.of_arm(arm))
            if found is not None:
                steps, middle, low, high = found
                axes.plot(steps, middle, color=colour, linestyle=dashes, linewidth=1.2, label=title_of(arm))
                axes.fill_between(steps, low, high, color=colour, alpha=0.13, linewidth=0)
        axes.set(
            xlabel="environment steps (millions)", ylabel="robots that keep their skill, training", ylim=(0.0, 1.0)
        )
        axes.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
        axes.grid(color=GRID, linewidth=0.5)
        axes.set_axisbelow(True)
        figure.legend(loc="outside lower center", ncols=2, fontsize=7, handlelength=2.4)
    return figure


def draw_confusions(result: StudyResult) -> Figure:
    """Fraction of each commanded gait's walks by what they show, all seeds together; a panel for each arm."""
    panels = []
    for arm in result.arms:
        runs = result.of_arm(arm)
        if runs:
            names, shown, _ = gait_counts(runs[0].labelled)
            counts = pooled([gait_counts(run.labelled)[2] for run in runs])
            columns = [*shown[:-1], "none or fell"]
            panels.append(Panel(title_of(arm), counts / counts.sum(axis=1, keepdims=True), names, columns))
    return draw_panels(panels, Scale(0.0, 1.0, "fraction of walks"), Axis("commanded", "shown"))


def draw_measures(result: StudyResult) -> Figure:
    """Every measure of every arm: seeds as marks, their mean and its interval as a line."""
    known = measures(result)
    limits = {GAITS_SHOWN: result.thresholds.distinct_gaits, INFORMATION: result.thresholds.information_bits}
    with style():
        figure = new_figure((PAGE, 0.9 + 0.21 * len(result.arms)))
        axes = figure.subplots(1, len(known), sharey=True)
        for axis, (name, measure) in zip(axes, known.items(), strict=True):
            for place, arm in enumerate(result.arms):
                _draw_arm(axis, place, by_seed(result.of_arm(arm), measure))
            if name in limits:
                axis.axvline(limits[name], color=GREY, linewidth=0.8, linestyle=(0, (3, 2)))
            axis.xaxis.set_major_locator(MaxNLocator(3, integer=name == GAITS_SHOWN))
            axis.set_xlabel(name.replace(" (", "\n("), fontsize=7.5)
            greatest = max(axis.dataLim.x1, 0.1)  # no measure is negative
            axis.set_xlim(-0.04 * greatest, 1.04 * greatest)
            axis.grid(axis="x", color=GRID, linewidth=0.5)
            axis.set_axisbelow(True)
            axis.tick_params(labelsize=7)
        axes[0].set_yticks(range(len(result.arms)), [title_of(arm) for arm in result.arms])
        axes[0].set_ylim(len(result.arms) - 0.5, -0.5)
    return figure


def _draw_arm(axes: Axes, place: int, values: dict[int, float]) -> None:
    found = over_seeds(values)
    if found is not None:
        axes.plot([found.low, found.high], [place, place], color="#0072B2", linewidth=1.6, solid_capstyle="butt")
        axes.plot([found.value], [place], "|", color="#0072B2", ms=8, mew=1.6)
        axes.plot(list(values.values()), [place] * len(values), "o", color=INK, ms=2.6, alpha=0.7, mew=0)
