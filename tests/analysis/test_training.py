"""The learning curves: what becomes a point, and that whatever was recorded can be drawn and read."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from analysis.style import GAIT_COLOURS
from analysis.training import compute_curves, draw_curves, running_mean
from camp.common.histogram import EDGES
from camp.deployment.provenance import condensed
from camp.gaits.schedule import GAIT_PHASES
from tests.analysis.synthetic import metrics

PANELS = ("gait", "reward", "error", "falls", "accuracy", "logits", "kl", "rate")
TWELVE = tuple(f"{gait}_{frequency}hz" for gait in GAIT_PHASES for frequency in (2, 3, 4))


def panels(rows: list[dict[str, Any]]) -> dict[str, Axes]:
    """The figure's axes by name."""
    return {axes.get_label(): axes for axes in draw_curves(compute_curves(rows)).axes}


def labels(axes: Axes) -> list[str]:
    legend = axes.get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


def test_running_mean_takes_what_there_is_at_the_ends():
    values = np.array([0.0, 3.0, 6.0, 0.0])
    np.testing.assert_allclose(running_mean(values, 1), [1.5, 3.0, 3.0, 3.0])
    np.testing.assert_array_equal(running_mean(values, 0), values)
    np.testing.assert_allclose(running_mean(values[:2], 5), [1.5, 1.5])


def test_what_a_row_lacks_is_no_point():
    training = compute_curves(metrics(12))
    np.testing.assert_allclose(training.curves["gait/trot_2hz/accuracy"].steps, [0.05, 0.10])  # millions
    assert len(training.curves["ppo/kl"].steps) == 11
    assert len(training.curves["reward/task/raw"].steps) == 12


def test_a_reading_of_logits_fills_the_time_since_the_one_before():
    spread = compute_curves(metrics(15)).spread
    assert spread is not None and spread.fraction.shape == (3, 24)
    np.testing.assert_allclose(spread.edges, [0.0, 0.05, 0.10, 0.15])
    late = compute_curves([row for row in metrics(30) if row["iteration"] > 15]).spread
    assert late is not None
    np.testing.assert_allclose(late.edges, [0.15, 0.20, 0.25, 0.30])


def test_a_condensed_curve_tells_the_same():
    whole, short = compute_curves(metrics(600)), compute_curves(condensed(metrics(600)))
    assert whole.curves.keys() == short.curves.keys()
    assert len(short.curves["reward/task/raw"].steps) == 200
    assert short.spread is not None and short.spread.fraction[:, 13].min() == 1.0


def test_skills_are_told_apart_by_colour_and_dashes():
    gait = panels(metrics(20))["gait"]
    assert labels(gait) == ["trot_2hz", "trot_3hz", "pace_2hz", "pace_3hz"]
    shown = {str(line.get_label()): line for line in gait.get_lines()}
    for gait_name in ("trot", "pace"):
        slow, fast = shown[f"{gait_name}_2hz"], shown[f"{gait_name}_3hz"]
        assert slow.get_color() == fast.get_color() == GAIT_COLOURS[gait_name]
        assert (slow.get_linestyle(), fast.get_linestyle()) == ("--", "-")
    assert all(line.get_linestyle() == "-" for line in panels(metrics(20, ("trot", "pace")))["gait"].get_lines())


def test_logits_are_a_map_where_histograms_were_recorded_and_means_else():
    rows = metrics(20)
    logits = panels(rows)["logits"]
    (mesh,) = (found for found in logits.collections if isinstance(found, QuadMesh))
    assert np.asarray(mesh.get_array()).reshape(24, 4)[13].tolist() == [1.0] * 4
    assert labels(logits) == ["expert, mean"]
    low, high = logits.get_ylim()
    assert low <= EDGES[13] and EDGES[14] <= high
    for row in rows:
        row.pop("prior/style/logit_histogram/policy", None)
    assert labels(panels(rows)["logits"]) == ["expert, mean", "policy, mean"]


def test_a_run_without_priors_is_drawn_without_their_lines():
    drawn = panels([{key: value for key, value in row.items() if "/s" not in key} for row in metrics(20)])
    assert labels(drawn["reward"]) == ["task"]
    for name in ("accuracy", "logits"):
        assert drawn[name].get_lines() == [] and drawn[name].texts[0].get_text() == "not recorded"


@pytest.mark.parametrize("iterations", [1, 2])
def test_points_of_a_run_just_begun_can_be_seen(iterations):
    drawn = panels(metrics(iterations))
    assert drawn["reward"].get_lines()[-1].get_marker() == "."
    assert drawn["gait"].texts[0].get_text() == "not recorded"


def test_falls_are_on_a_logarithmic_axis_unless_nobody_fell():
    rows = metrics(20)
    assert panels(rows)["falls"].get_yscale() == "log"
    assert panels([row | {"env/falls_per_1000_steps": 0.0} for row in rows])["falls"].get_yscale() == "linear"


def boxes(figure: Figure, axes: Axes) -> list[Any]:
    """Where title, legend, labels and numbers of a panel lie, in pixels."""
    legend = axes.get_legend()
    texts = [axes._left_title, *axes.texts, axes.xaxis.label, axes.yaxis.label]  # type: ignore[attr-defined]
    low, high = sorted(axes.get_ylim())
    ticks = [*axes.yaxis.get_major_ticks(), *axes.yaxis.get_minor_ticks()]
    numbers = [tick.label1 for tick in ticks if low <= tick.get_loc() <= high]
    shown = [text for text in [*texts, *numbers] if text.get_text()] + ([] if legend is None else [legend])
    return [part.get_window_extent(figure.canvas.get_renderer()) for part in shown]  # type: ignore[attr-defined]


@pytest.mark.parametrize("skills", [("trot", "pace"), TWELVE])
def test_no_text_lies_upon_another(skills):
    figure = draw_curves(compute_curves(metrics(40, skills)))
    figure.canvas.draw()
    found = [box for axes in figure.axes if axes.get_label() in PANELS for box in boxes(figure, axes)]
    assert all(figure.bbox.contains(*corner) for box in found for corner in (box.min, box.max))
    assert not any(one.overlaps(other) for one, other in combinations(found, 2))
