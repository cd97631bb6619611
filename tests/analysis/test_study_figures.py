"""Figures of results in ablations/results, on made-up ones."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from analysis import gallery
from analysis.incentive import Incentive, margin, margin_table, margins, read_incentives
from analysis.incentive_figure import draw_margins, draw_matrices
from analysis.load import AnalysisError
from analysis.matrices import Axis, Panel, Scale, draw_panels
from analysis.study_figures import curve_of, draw_learning
from analysis.study_results import write_result
from tests.analysis.studies import obedient, run_result, study_result


def test_margins_by_hand():
    # Diagonal 3, 1, mean 2; the rest 1, 0, mean .5. Commanded 0: 3 against 0; commanded 1: 1 against 1.
    found = margin(np.array([[3.0, 1.0], [0.0, 1.0]]))
    assert found.mean == pytest.approx(1.5) and found.worst == pytest.approx(0.0)


@pytest.fixture
def incentives(tmp_path):
    own, nothing = (2.0 * np.eye(2)).tolist(), np.zeros((2, 2)).tolist()
    rows = [
        Incentive(arm, fakes, seed, own if arm == "full" else nothing, nothing)
        for arm in ("full", "amp_baseline")
        for fakes in ("blind", "untrained")
        for seed in (0, 1)
    ]
    path = tmp_path / "incentive.json"
    path.write_text(json.dumps({"skills": ["trot", "pace"], "arms": [asdict(row) for row in rows]}))
    return path


def test_incentives_are_read_and_drawn(incentives):
    skills, rows = read_incentives(incentives)
    assert margins(rows)["full", "blind", "style"] == [2.0, 2.0]
    assert margins(rows)["amp_baseline", "untrained", "style"] == [0.0, 0.0]
    assert margin_table(rows).rows[0] == ["full", "blind", "2.00", "0.00", "2.00"]
    figure = draw_matrices(skills, rows)
    assert [text.get_text() for text in figure.axes[0].texts] == ["2.00", "0.00", "0.00", "2.00"]
    assert figure.axes[1].get_title() == "AMP baseline"
    assert len(draw_margins(rows).axes) == 2


def test_missing_results_name_their_command(tmp_path):
    with pytest.raises(AnalysisError, match=r"python -m analysis\.incentive"):
        read_incentives(tmp_path / "incentive.json")
    with pytest.raises(AnalysisError, match=r"python -m analysis\.latent_space"):
        gallery.FIGURES["dtw_expert"](gallery.Sources(tmp_path, tmp_path))
    with pytest.raises(AnalysisError, match="make ablations"):
        gallery.studies(tmp_path)


def test_every_figure_of_a_study_is_drawn(tmp_path):
    write_result(tmp_path / "made_up.json", study_result())
    (study,) = gallery.studies(tmp_path)
    for draw in gallery.STUDY_FIGURES.values():
        assert draw(study).axes
    assert gallery.tables(study).keys() == {"table.md", "table.tex", "table.csv", "seeds.csv"}


def test_learning_curves_have_the_interquartile_mean():
    runs = [run_result("full", seed, obedient()) for seed in range(7)]
    runs.append(replace(runs[0], curve_accuracy=[0.0, 9.9, 9.9]))  # an outlier, which a mean would follow
    steps, middle, low, high = curve_of(runs) or pytest.fail("no curve")
    np.testing.assert_allclose(steps, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(middle, [0.0, 0.35, 0.55])  # of 0, .1, ... .6 and 9.9 the middle four
    assert (low <= middle).all() and (middle <= high).all()
    labels = [text.get_text() for text in draw_learning(study_result()).legends[0].get_texts()]
    assert labels == ["full", "style not conditional"]


def test_empty_cells_have_no_number():
    panel = Panel("one", np.array([[1.0, np.nan]]), ["row"], ["a", "b"])
    figure = draw_panels([panel], Scale(0.0, 1.0, "share", digits=1), Axis("rows", "columns"))
    assert [text.get_text() for text in figure.axes[0].texts] == ["1.0", ""]
