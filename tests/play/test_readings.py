"""The diagram and the readout show the session's own contacts and numbers."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from camp.common.stretches import stretches
from camp.play import diagram as drawing
from camp.play.clock import Clock
from camp.play.colours import LEG_COLOURS, PUSH_COLOUR
from camp.play.diagram import diagram
from camp.play.readout import FALLEN, readout
from camp.play.session import Moment
from camp.play.words import skill_text

STILL = np.zeros(3, np.float32)


def bars(session, colour: str) -> list[tuple[float, float]]:
    """Begin and width of the rectangles of a colour, as fractions of the time shown."""
    span = drawing.WIDTH - drawing.LEFT
    found = [one for one in ElementTree.fromstring(diagram(session)).iter("rect") if one.get("fill") == colour]
    return [((float(one.get("x", "")) - drawing.LEFT) / span, float(one.get("width", "")) / span) for one in found]


def add(session, stands: tuple[bool, bool, bool, bool], steps: int, pushed: bool = False) -> None:
    session.moments.extend(Moment(stands, STILL, "trot_2hz", "none", pushed and step == 0) for step in range(steps))


def test_stretches_of_equal_values():
    assert stretches("aab") == [(0, 2, "a"), (2, 3, "b")]
    assert stretches([]) == []


def test_bars_are_the_stances_and_the_present_is_at_the_right(session):
    add(session, (True, False, False, True), 50)  # FL and RR for a second, then FR and RL for half a second
    add(session, (False, True, True, False), 25, pushed=True)
    early, late = (pytest.approx((0.625, 0.25), abs=1e-3), pytest.approx((0.875, 0.125), abs=1e-3))
    assert [bars(session, colour) for colour in LEG_COLOURS] == [[early], [late], [late], [early]]
    assert [begin for begin, _ in bars(session, PUSH_COLOUR)] == [pytest.approx(0.875, abs=1e-3)]


def test_bounces_are_closed_as_they_are_for_the_measure(session):
    add(session, (True, True, True, True), 20)
    add(session, (False, True, True, True), 1)
    add(session, (True, True, True, True), 20)
    assert len(bars(session, LEG_COLOURS[0])) == 1


def test_the_diagram_of_a_walk_is_small_and_well_formed(session):
    assert ElementTree.fromstring(diagram(session)).tag == "svg"  # before the first step
    session.steer((0.6, 0.0, 0.0))
    for _ in range(1000):
        session.tick()
    text = diagram(session)
    assert "Trot" in text and len(text) < 20_000  # sent ten times a second
    assert 6 <= len(bars(session, LEG_COLOURS[0])) <= 10  # 4 s at 2 strides per s


def test_the_readout_compares_what_is_measured_with_what_was_asked_for(session):
    clock = Clock(0.005)
    text = readout(session, clock)
    assert 'data-skill="none"' in text and "No gait" in text and "as asked" not in text
    session.steer((0.6, 0.0, 0.0))
    for _ in range(500):
        session.tick()
    text = readout(session, clock)
    assert 'data-skill="trot_2hz"' in text and "✓ as asked" in text and 'data-state="walking"' in text
    assert "<td>+0.60</td><td>+0.00</td><td>+0.00</td>" in text
    shown = re.search(r'data-vx="([^"]*)"', text)
    assert shown is not None and session.measured.velocity is not None
    assert float(shown[1]) == pytest.approx(session.measured.velocity[0], abs=0.005)
    session.choose("pace_2hz")
    assert "not (yet) as asked" in readout(session, clock)
    session.fallen = True
    assert FALLEN in readout(session, clock)
    clock.paused = True
    assert 'data-state="paused"' in readout(session, clock)


def test_the_real_time_factor_is_shown_beside_the_one_that_was_asked_for(session):
    clock = Clock(0.005)
    clock.speed = 0.25
    assert "real-time factor 0.00, 0.25 asked for" in readout(session, clock)


def test_skills_in_words():
    assert skill_text("trot_2hz") == "Trot, 2 strides/s"
    assert skill_text("slow_walk") == "Slow walk"
