"""Quality of made-up motion: every figure worked by hand."""

from __future__ import annotations

import pytest

from camp.evaluation.quality import summarize_quality
from camp.evaluation.reading import read
from camp.robots.go2 import GO2
from tests.evaluation.synthetic import GAITS, SKILLS, grid


def test_figures_by_hand():
    quality = summarize_quality(GO2, read(grid({gait: gait for gait in GAITS}), SKILLS, 2.0))["trot"]
    assert quality.falls_per_minute == 0.0
    assert quality.peak_torque_share == pytest.approx(10 / 23.7)  # 10 N m throughout, hips and thighs are weakest
    assert quality.torque_at_limit_share == 0.0
    assert quality.foot_slip_m_s == pytest.approx(0.2)
    assert quality.power_w == pytest.approx(15.0)
    # Only the command of .5 m/s moves; it is followed at .6.
    mass = GO2.load_model().body_mass.sum()
    assert quality.cost_of_transport == pytest.approx(15.0 / (mass * 9.81 * 0.6))
    # A sine of .1 rad a step: its mean change is 2 / pi of .1.
    assert quality.action_rate_rad == pytest.approx(0.0637, rel=0.02)


def test_falls_count_by_the_time_upright():
    recording = grid({gait: gait for gait in GAITS})
    recording.steps_upright[0] = 250  # 5 s of one trot and 10 s of the other
    quality = summarize_quality(GO2, read(recording, SKILLS, 2.0))
    assert quality["trot"].falls_per_minute == pytest.approx(60 / 15)
    assert quality["pace"].falls_per_minute == 0.0
