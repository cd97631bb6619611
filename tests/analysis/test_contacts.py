"""The foot-contact diagram of a switching sequence."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from analysis.contacts import Span, compute_diagram, draw_diagram, spans
from analysis.load import SwitchingSequence
from analysis.style import save
from camp.gaits.schedule import GAIT_PHASES

PERIOD = 0.02  # s


@pytest.fixture
def sequence():
    """Two seconds of trot, then two of pronk, 2 Hz, duty .5."""
    stride = np.arange(200)[:, None] * PERIOD * 2.0
    gaits = np.repeat(["trot", "pronk"], 100)
    offset = np.array([GAIT_PHASES[gait] for gait in gaits])
    return SwitchingSequence(PERIOD, ("pronk", "trot"), np.mod(stride - offset, 1.0) < 0.5, np.repeat([1, 0], 100))


def test_spans_by_hand():
    assert spans(["a", "a", "b", "a"], 0.5) == [Span(0.0, 1.0, "a"), Span(1.0, 1.5, "b"), Span(1.5, 2.0, "a")]
    assert spans([], 0.5) == []


def test_diagram_tells_commanded_from_measured(sequence):
    diagram = compute_diagram(sequence)
    assert diagram.commanded == [Span(0.0, 2.0, "trot"), Span(2.0, 4.0, "pronk")]
    assert (diagram.measured[0].name, diagram.measured[-1].name) == ("trot", "pronk")
    assert diagram.measured[0].end_s == pytest.approx(2.0, abs=0.5)


def test_stance_adds_up_to_the_time_on_the_floor(sequence):
    diagram = compute_diagram(sequence)
    for foot, stance in enumerate(diagram.stance):
        total = sum(span.end_s - span.start_s for span in stance)
        assert total == pytest.approx(sequence.contact[:, foot].sum() * PERIOD)


def test_a_foot_that_never_lands_has_no_bar(sequence):
    sequence.contact[:, 2] = False
    assert compute_diagram(sequence).stance[2] == []


def test_figure_names_feet_and_skills(sequence, tmp_path):
    figure = draw_diagram(compute_diagram(sequence))
    assert isinstance(figure, Figure)
    feet = figure.axes[0]
    assert [label.get_text() for label in feet.get_yticklabels()] == ["FL", "FR", "RL", "RR"]
    assert [text.get_text() for text in feet.texts] == ["commanded: trot", "pronk"]
    assert save(figure, tmp_path / "contacts.png").stat().st_size > 10_000
