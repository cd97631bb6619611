"""Tracking of the expert's mean stride; worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.metrics.reference import PHASES, mean_stride, reference_tracking

PERIOD = 0.02


def wave(frequency: float, seconds: float = 4.0, shift: float = 0.0) -> np.ndarray:
    """Two joints: a sine, and a cosine of double amplitude about 1."""
    angle = 2 * np.pi * (np.arange(round(seconds / PERIOD)) * PERIOD * frequency + shift)
    return np.stack([np.sin(angle), 1 + 2 * np.cos(angle)], axis=1)


def test_the_mean_stride_of_a_periodic_motion_is_the_motion():
    angle = 2 * np.pi * np.arange(PHASES) / PHASES
    expected = np.stack([np.sin(angle), 1 + 2 * np.cos(angle)], axis=1)
    np.testing.assert_allclose(mean_stride(wave(2.0), 2.0, PERIOD), expected, atol=0.02)


def test_the_same_motion_at_another_frequency_and_phase_is_tracked():
    found = reference_tracking(wave(2.1, 8.0, shift=0.3), mean_stride(wave(2.0), 2.0, PERIOD), 2.1, PERIOD)
    assert (found.accuracy > 0.98).all() and (found.skill > 0.95).all()


def test_no_constant_pose_has_skill():
    stride = mean_stride(wave(2.0), 2.0, PERIOD)
    best = np.repeat(np.median(stride, axis=0)[None], 400, axis=0)
    np.testing.assert_allclose(reference_tracking(best, stride, 2.0, PERIOD).skill, 0.0, atol=0.005)
    for offset in (-0.3, 0.0, 0.2):
        assert (reference_tracking(best + offset, stride, 2.0, PERIOD).skill < 1e-12).all()


def test_joints_in_the_wrong_order_of_time_are_not():
    # The second joint a quarter stride off: one shift cannot serve both.
    late = np.stack([wave(2.0)[:, 0], wave(2.0, shift=0.25)[:, 1]], axis=1)
    found = reference_tracking(late, mean_stride(wave(2.0), 2.0, PERIOD), 2.0, PERIOD)
    assert found.skill.min() < 0.3


def test_an_error_by_hand():
    stride = np.zeros((PHASES, 1))
    stride[PHASES // 2 :] = 1.0  # range 1, median .5, mean distance .5
    still = np.full((100, 1), 0.25)
    found = reference_tracking(still, stride, 2.0, PERIOD)
    assert found.accuracy == pytest.approx(0.5, abs=0.02) and found.skill == pytest.approx(0.0, abs=0.03)


def test_less_than_a_stride_is_refused():
    with pytest.raises(ValueError, match="no stride of 2 Hz"):
        mean_stride(wave(2.0, 0.3), 2.0, PERIOD)
    with pytest.raises(ValueError, match="no stride of 2 Hz"):
        reference_tracking(wave(2.0, 0.3), np.zeros((PHASES, 2)), 2.0, PERIOD)
