"""Tracking measures against values worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.metrics.tracking import (
    VelocityError,
    by_joint_kind,
    mean_velocity,
    velocity_error,
    velocity_error_by_command,
    velocity_error_by_turn,
)


def test_velocity_error_by_hand():
    error = velocity_error(np.array([1.0, 0.0, 0.5]), np.array([[0.7, 0.4, -0.5], [1.0, 0.0, 0.5]]))
    np.testing.assert_allclose(error.linear, [0.5, 0.0], atol=1e-12)  # a 3-4-5 triangle
    np.testing.assert_allclose(error.angular, [1.0, 0.0], atol=1e-12)


def test_mean_velocity_over_whole_strides_drops_the_sway():
    time = np.arange(110) * 0.02  # 2.2 s of a 2-Hz stride: four strides and a fraction
    velocity = np.stack([0.5 + 0.2 * np.sin(2 * np.pi * 2 * time), 0 * time, 0 * time], axis=-1)
    assert mean_velocity(velocity, 0.02, 2.0)[0] == pytest.approx(0.5, abs=1e-12)
    assert abs(mean_velocity(velocity, 0.02)[0] - 0.5) > 0.005


def test_mean_velocity_of_less_than_a_stride_uses_all_steps():
    velocity = np.array([[[1.0, 0, 0], [3.0, 0, 0]]])
    np.testing.assert_allclose(mean_velocity(velocity, 0.02, 2.0), [[2.0, 0, 0]])


def test_velocity_error_by_command_keeps_slow_and_fast_apart():
    command = np.array([[0.0, 0.0, 1.0], [0.0, 0.3, 0.0], [-0.6, 0.8, 0.0]])
    error = VelocityError(linear=np.array([[0.1, 0.3, 0.5], [0.1, 0.1, 0.7]]), angular=np.zeros((2, 3)))
    binned = velocity_error_by_command(command, error, (0.4,))
    assert list(binned) == ["below 0.4 m/s", "from 0.4 m/s"]
    assert binned["below 0.4 m/s"].linear == pytest.approx(0.15)
    assert binned["from 0.4 m/s"].linear == pytest.approx(0.6)


def test_velocity_error_by_turn_does_not_ask_for_the_direction():
    command = np.array([[0.5, 0.0, 0.6], [0.5, 0.0, -0.6], [0.5, 0.0, 0.1]])
    error = VelocityError(linear=np.zeros(3), angular=np.array([0.1, 0.3, 0.5]))
    binned = velocity_error_by_turn(command, error, (0.3,))
    assert list(binned) == ["below 0.3 rad/s", "from 0.3 rad/s"]
    assert binned["from 0.3 rad/s"].angular == pytest.approx(0.2)


def test_empty_bins_are_left_out_and_inner_bins_named():
    error = VelocityError(linear=np.array([0.2]), angular=np.array([0.1]))
    assert list(velocity_error_by_command(np.array([[0.5, 0, 0]]), error, (0.4, 0.8))) == ["0.4 to 0.8 m/s"]


def test_by_joint_kind_averages_the_legs():
    kinds = by_joint_kind(np.arange(12.0)[None])
    assert {kind: value.tolist() for kind, value in kinds.items()} == {
        "hip": [4.5],
        "thigh": [5.5],
        "calf": [6.5],
    }
