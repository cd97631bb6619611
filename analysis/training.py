"""Learning curves of a run against environment steps."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, PercentFormatter
from numpy.typing import NDArray

from analysis.style import GRID, INK, PAGE, TERM_COLOURS, new_figure, skill_colours, style
from camp.common.histogram import EDGES
from camp.gaits.skills import split_name
from camp.metrics.tracking import FAST_COMMAND_M_S

LAYOUT: list[Any] = [  # two rows to a panel, but for the two halves of the policy's
    ["gait", "gait"],
    ["gait", "gait"],
    ["reward", "error"],
    ["reward", "error"],
    ["falls", "accuracy"],
    ["falls", "accuracy"],
    ["logits", "kl"],
    ["logits", "rate"],
]
POLICY_LOGITS = "prior/style/logit_histogram/policy"
VISIBLE_FRACTION = 0.002  # of the policy's logits: bins that never hold as much are cut off where they are outermost
SMOOTHED_PART = 30  # the running mean reaches a 30th of the points to either side
FEW = 10  # points, up to which each gets a mark
COLUMNS = 4  # of a legend at most
DECADES = 9  # of a logarithmic axis that get their tick
LEGEND: dict[str, Any] = {
    "fontsize": 7.0,
    "handlelength": 2.2,
    "columnspacing": 1.2,
    "borderpad": 0.1,
    "borderaxespad": 0.5,
}

_GAIT_ACCURACY = re.compile(r"gait/([^/]+)/accuracy")
_STRIDES = ("-", (0, (4, 1.5)), (0, (1, 1.2)))  # from the highest stride frequency down
_DASHED = _STRIDES[1]


@dataclass(frozen=True)
class Curve:
    """One number over training, P points.

    steps: (P,) environment steps in millions; value: (P,) in the metric's unit; trend: (P,) its running mean.
    """

    steps: NDArray[np.floating]
    value: NDArray[np.floating]
    trend: NDArray[np.floating]


@dataclass(frozen=True)
class LogitSpread:
    """How the policy's logits were spread at each of P readings.

    edges: (P + 1,) environment steps in millions; a reading fills the time since the one before; fraction: (P, B) in
    the bins of `camp.common.histogram`.
    """

    edges: NDArray[np.floating]
    fraction: NDArray[np.floating]


@dataclass(frozen=True)
class TrainingCurves:
    """curves: by metric key; spread: None where no histogram was recorded."""

    curves: dict[str, Curve]
    spread: LogitSpread | None


class Line(NamedTuple):
    """How one metric is drawn."""

    key: str
    label: str
    colour: str
    dashes: Any = "-"


REWARD = [Line(f"reward/{term}/raw", term, colour) for term, colour in TERM_COLOURS.items()]
ERROR = [
    Line("tracking/linear_error_fast", f"linear, at ≥ {FAST_COMMAND_M_S:g} m/s", INK),
    Line("tracking/yaw_rate_error", "yaw rate", INK, _DASHED),
]
FALLS = Line("env/falls_per_1000_steps", "running mean (faint: as recorded)", INK)
ACCURACY = [
    Line("prior/style/accuracy", "style: expert or policy", TERM_COLOURS["style"]),
    Line("prior/skill/policy_accuracy", "skill: of the policy", TERM_COLOURS["skill"]),
]
EXPERT_LOGIT = Line("prior/style/expert_logit", "expert, mean", TERM_COLOURS["style"])
POLICY_LOGIT = Line("prior/style/policy_logit", "policy, mean", INK)
KL = Line("ppo/kl", "KL to the policy before", INK)
LEARNING_RATE = Line("ppo/learning_rate", "", INK)


def compute_curves(rows: Sequence[dict[str, Any]]) -> TrainingCurves:
    """Turn rows of metrics, whole or condensed, into curves; a number that a row lacks is no point of its curve."""
    recorded = [key for row in rows for key, value in row.items() if isinstance(value, int | float)]
    spread = _points(rows, POLICY_LOGITS)
    return TrainingCurves(
        curves={key: _curve(*_points(rows, key)) for key in dict.fromkeys(recorded)},
        spread=LogitSpread(_reading_edges(spread[0]), spread[1]) if len(spread[0]) else None,
    )


def running_mean(values: NDArray[np.floating], reach: int) -> NDArray[np.floating]:
    """Means (P,) of each value and up to `reach` to either side, as many as there are."""
    window = np.ones(2 * reach + 1)
    sums, counts = (np.convolve(part, window)[reach : reach + len(values)] for part in (values, np.ones(len(values))))
    return sums / counts


def _points(rows: Sequence[dict[str, Any]], key: str) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Steps (P,) in millions and values (P, ...) of the rows that have the key."""
    found = [row for row in rows if row.get(key) is not None]
    return np.array([row["steps"] / 1e6 for row in found]), np.array([row[key] for row in found], dtype=float)


def _curve(steps: NDArray[np.floating], value: NDArray[np.floating]) -> Curve:
    return Curve(steps, value, running_mean(value, round(len(value) / SMOOTHED_PART)))


def _reading_edges(steps: NDArray[np.floating]) -> NDArray[np.floating]:
    first = max(0.0, 2 * steps[0] - steps[1]) if len(steps) > 1 else 0.0
    return np.concatenate([[first], steps])


def draw_curves(training: TrainingCurves) -> Figure:
    """Gaits, rewards, errors, falls, discriminators and the policy's update; faint lines are the values as recorded,
    strong ones their running means. What was not recorded is left out."""
    with style():
        figure = new_figure((PAGE, 8.2))
        figure.set_layout_engine("constrained", w_pad=0.1)  # inches
        panels = figure.subplot_mosaic(LAYOUT, sharex=True)
        _draw_gaits(panels["gait"], training)
        _draw_panel(panels["reward"], training, REWARD, "Reward terms, unweighted", "mean per step")
        _draw_panel(panels["error"], training, ERROR, "Velocity error", "error (m/s, rad/s)")
        _draw_panel(panels["falls"], training, [FALLS], "Falls", "falls per 1000 steps")
        _draw_panel(panels["accuracy"], training, ACCURACY, "Discriminators", "fraction right")
        _draw_logits(panels["logits"], training)
        _draw_panel(panels["kl"], training, [KL], "Policy update", "KL (nat)")
        _draw_panel(panels["rate"], training, [LEARNING_RATE], None, "learning rate")
        for name in ("gait", "accuracy"):
            panels[name].set_ylim(0.0, 1.0)
            panels[name].yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
        _make_logarithmic(panels["falls"], 3.0)
        _make_logarithmic(panels["rate"], 1.5)
        panels["gait"].tick_params(axis="x", labelbottom=True)  # wider than the others
        panels["gait"].xaxis.set_major_locator(MaxNLocator(5))  # shared by all
        panels["gait"].set_xlim(0.0, 1.01 * max(curve.steps[-1] for curve in training.curves.values()))
        for name in LAYOUT[-1]:
            panels[name].set_xlabel("environment steps (millions)")
        for column in (0, 1):
            figure.align_ylabels([panels[row[column]] for row in LAYOUT])
    return figure


def _draw_panel(axes: Axes, training: TrainingCurves, lines: Sequence[Line], title: str | None, unit: str) -> None:
    """Those of the lines that were recorded. The legend stands between title and axes, where it hides no curve."""
    drawn = [_draw_line(axes, training.curves[line.key], line) for line in lines if line.key in training.curves]
    axes.set_ylabel(unit)
    axes.grid(axis="y", color=GRID, linewidth=0.5)
    axes.set_axisbelow(True)
    if not drawn:
        axes.text(0.5, 0.5, "not recorded", transform=axes.transAxes, ha="center", va="center", color="#999999")
        axes.set_yticks([])
    if title is None:
        return
    rows = max(1, -(-len(drawn) // COLUMNS))
    axes.set_title(title, loc="left", pad=6 + 11 * rows)
    if drawn:
        # Left out of the layout, which would else give the panels unequal widths; the title's distance makes room.
        columns = -(-len(drawn) // rows)
        legend = axes.legend(handles=drawn, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, **LEGEND)
        legend.set_in_layout(False)


def _draw_line(axes: Axes, curve: Curve, line: Line) -> Line2D:
    axes.plot(curve.steps, curve.value, color=line.colour, linewidth=0.6, alpha=0.25)
    mark = "." if len(curve.steps) <= FEW else None
    look = {"color": line.colour, "linestyle": line.dashes, "linewidth": 1.2, "marker": mark, "label": line.label}
    return axes.plot(curve.steps, curve.trend, **look)[0]


def _draw_gaits(axes: Axes, training: TrainingCurves) -> None:
    skills = [match[1] for key in training.curves if (match := _GAIT_ACCURACY.fullmatch(key))]
    strides = sorted({_stride_hz(skill) for skill in skills}, reverse=True)
    dashes = {stride: _STRIDES[index % len(_STRIDES)] for index, stride in enumerate(strides)}
    lines = [
        Line(f"gait/{skill}/accuracy", skill, colour, dashes[_stride_hz(skill)])
        for skill, colour in skill_colours(skills).items()
    ]
    _draw_panel(axes, training, lines, "Robots that show the commanded skill, by foot contacts", "fraction of robots")


def _stride_hz(skill: str) -> float:
    """A skill's stride frequency; 0 where it may have any."""
    return split_name(skill)[1] or 0.0


def _draw_logits(axes: Axes, training: TrainingCurves) -> None:
    lines = [EXPERT_LOGIT, POLICY_LOGIT] if training.spread is None else [EXPERT_LOGIT]
    _draw_panel(axes, training, lines, "Style discriminator's logits", "logit")
    if training.spread is not None:
        _draw_spread(axes, training.spread)


def _draw_spread(axes: Axes, spread: LogitSpread) -> None:
    """The policy's logits as a map, its scale in the legend's row."""
    image = axes.pcolormesh(spread.edges, EDGES, spread.fraction.T, cmap="Greys", vmin=0.0, rasterized=True)
    seen = np.flatnonzero(spread.fraction.max(axis=0) >= VISIBLE_FRACTION)
    axes.set_ylim(min(EDGES[seen[0]], -1.25), max(EDGES[seen[-1] + 1], 1.25))
    axes.grid(False)
    scale = axes.inset_axes((0.62, 1.045, 0.24, 0.06))
    image.figure.colorbar(image, cax=scale, orientation="horizontal", ticks=[])
    for x, side, text in ((-0.06, "right", "policy 0%"), (1.06, "left", f"{spread.fraction.max():.0%}")):
        scale.text(x, 0.5, text, transform=scale.transAxes, ha=side, va="center", fontsize=LEGEND["fontsize"])


def _make_logarithmic(axes: Axes, roomy: float) -> None:
    """Where there is anything to show on such an axis: nothing but zeros has no place on it.

    roomy: decades up to which not only powers of ten get a number, but 2 and 5 times them too.
    """
    if any((np.asarray(line.get_ydata(), dtype=float) > 0.0).any() for line in axes.get_lines()):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(numticks=DECADES))
        low, high = np.log10(axes.get_ylim())
        shown = "123456789" if high - low < 0.7 else "125" if high - low < roomy else "1"
        for set_formatter in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
            set_formatter(FuncFormatter(lambda value, _: _short(value) if f"{value:e}"[0] in shown else ""))


def _short(value: float) -> str:
    """0.5, or 5e-5 where that is shorter."""
    plain = np.format_float_positional(value, 3, fractional=False, trim="-")
    return min(plain, np.format_float_scientific(value, 2, trim="-", exp_digits=1), key=len)
