"""One policy's evaluation drawn: confusion of commanded and shown skills, Table I and friction, single disturbances."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from analysis.load import AnalysisError
from analysis.matrices import Axis, Panel, Scale, draw_panels
from analysis.style import GRID, INK, PAGE, new_figure, skill_shades, style
from camp.evaluation.reading import FELL
from camp.evaluation.report import FrictionBin, PolicySummary, Report
from camp.gaits.skills import NO_SKILL

LINE = "#0072B2"


def confusion_panel(title: str, summary: PolicySummary) -> Panel:
    """Fractions of each commanded skill's walks by what they show, in per cent; empty cells where none does.

    What ended in a fall has a column of its own, so that the diagonal is the gait accuracy of the tables.
    """
    skills = list(summary.confusion)
    shown = [*skills, NO_SKILL, FELL]
    counts = np.array([[summary.confusion[row].get(name, 0) for name in shown] for row in skills], dtype=float)
    fractions = 100.0 * counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    return Panel(title, np.where(counts > 0, fractions, np.nan), skills, shown)


def draw_confusion(report: Report) -> Figure:
    """Commanded by shown skill: nominal, and under the whole of Table I where it was evaluated."""
    if "trained" not in report.policies:
        raise AnalysisError(
            f"the evaluation of {report.run} has no walks: evaluate it with the part `gait`, "
            "`python -m camp.evaluate run=<its folder>`"
        )
    panels = [confusion_panel("nominal", report.policies["trained"])]
    if report.table_i is not None:
        panels.append(confusion_panel("Table I, noise and pushes", report.table_i.walks))
    return draw_panels(panels, Scale(0.0, 100.0, "walks (%)", digits=0), Axis("commanded", "shown"), columns=2)


def draw_robustness(report: Report) -> Figure:
    """Right walks by friction under Table I, by skill, and under one disturbance at a time."""
    if report.table_i is None or not report.robustness:
        raise AnalysisError(
            f"the evaluation of {report.run} lacks Table I or single disturbances: evaluate it with suite=full, "
            "`python -m camp.evaluate run=<its folder>`"
        )
    with style():
        figure = new_figure((PAGE, 3.9))
        parts: Any = figure.subfigures(1, 2, width_ratios=(1, 1.15))
        left, right = parts
        friction, skills = left.subplots(2, 1)
        _draw_friction(friction, report.table_i.friction)
        _draw_skills(skills, report)
        _draw_conditions(right.subplots(), report)
    return figure


def _draw_friction(axes: Axes, bins: list[FrictionBin]) -> None:
    for place, one in enumerate(bins):
        if one.right is not None:
            axes.plot([place, place], [one.right.low, one.right.high], color=LINE, linewidth=1.6)
            axes.plot([place], [one.right.value], "o", color=LINE, ms=4)
            axes.annotate(f"n = {one.right.n}", (place, 0.02), ha="center", fontsize=6.5)
    axes.set_xticks(range(len(bins)), [_range(one.low, one.high) for one in bins])
    axes.set_xlim(-0.5, len(bins) - 0.5)
    axes.set_xlabel("friction, all else drawn from Table I")
    _percent(axes)


def _draw_skills(axes: Axes, report: Report) -> None:
    assert report.table_i is not None
    names, shades = list(report.skills), skill_shades(list(report.skills))
    for place, skill in enumerate(names):
        for summary, mark, offset in ((report.policies["trained"], "o", -0.15), (report.table_i.walks, "s", 0.15)):
            found = summary.skills[skill].gait_accuracy
            if found is not None:
                axes.plot([place + offset] * 2, [found.low, found.high], color=shades[skill], linewidth=1.6)
                axes.plot([place + offset], [found.value], mark, color=shades[skill], ms=3.5)
    for mark, label in (("o", "nominal"), ("s", "Table I")):
        axes.plot([], [], mark, color=INK, ms=3.5, label=label)
    axes.set_xticks(range(len(names)), names, rotation=45, ha="right", rotation_mode="anchor")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.0, handletextpad=0.1)
    _percent(axes)


def _draw_conditions(axes: Axes, report: Report) -> None:
    for place, summary in enumerate(report.robustness.values()):
        found = summary.gait_accuracy
        if found is not None:
            axes.plot([found.low, found.high], [place, place], color=LINE, linewidth=1.6)
            axes.plot([found.value], [place], "o", color=LINE, ms=3.5)
    axes.set_yticks(range(len(report.robustness)), list(report.robustness), fontsize=6.5)
    axes.set_ylim(len(report.robustness) - 0.5, -0.5)
    axes.set_xlim(0.0, 1.02)
    axes.xaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    axes.grid(axis="x", color=GRID, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.set_xlabel("walks right, one disturbance at a time")


def _percent(axes: Axes) -> None:
    axes.set_ylim(0.0, 1.03)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    axes.set_ylabel("walks right")
    axes.grid(axis="y", color=GRID, linewidth=0.5)
    axes.set_axisbelow(True)


def _range(low: float | None, high: float | None) -> str:
    if low is None:
        return f"below {high:g}"
    return f"from {low:g}" if high is None else f"{low:g} to {high:g}"
