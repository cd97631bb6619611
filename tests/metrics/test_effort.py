"""Effort against values worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.metrics.effort import (
    action_rate,
    cost_of_transport,
    foot_slip,
    fraction_at_limit,
    fraction_near_stop,
    torque_use,
    velocity_jump,
)


def test_action_rate_is_the_mean_step_of_the_targets():
    target = np.array([[0.0, 1.0], [0.1, 1.0], [-0.1, 0.8]])  # steps .1, 0, .2, .2
    assert action_rate(target) == pytest.approx(0.125)
    assert action_rate(np.stack([target, 2 * target])).tolist() == pytest.approx([0.125, 0.25])


def test_torque_use_takes_the_joint_nearest_its_limit():
    torque = np.array([[10.0, -30.0], [-20.0, 0.0]])
    np.testing.assert_allclose(torque_use(torque, np.array([20.0, 40.0])), [0.75, 1.0])


def test_fraction_at_limit_counts_both_signs():
    value = np.array([[20.0, 0.0], [-19.9, 39.0]])  # 2 of 4 within a percent
    assert fraction_at_limit(value, np.array([20.0, 40.0])) == pytest.approx(0.5)


def test_fraction_near_stop_counts_both_stops_and_beyond():
    position = np.array([[-1.1], [-0.96], [0.0], [0.94], [0.99]])  # stops +-1, margin .05
    assert fraction_near_stop(position, np.array([-1.0]), np.array([1.0]), 0.05) == pytest.approx(3 / 5)


def test_velocity_jump_is_the_largest_change_of_a_step():
    velocity = np.array([[0.0, 0.0], [1.0, -3.0], [1.5, -3.0]])
    np.testing.assert_allclose(velocity_jump(velocity), [0.0, 3.0, 0.5])
    assert velocity_jump(np.stack([velocity] * 4)).shape == (4, 3)


def test_foot_slip_leaves_out_touchdown_lift_off_and_swing():
    contact = np.zeros((6, 4), dtype=bool)
    contact[1:5, 0] = True  # rows 2 and 3 are in the midst of the stance
    speed = np.full((6, 4), 9.0)
    speed[[2, 3], 0] = 0.1, 0.3
    assert foot_slip(speed, contact) == pytest.approx(0.2)


def test_foot_slip_without_stance_is_nan():
    contact = np.zeros((2, 6, 4), dtype=bool)
    contact[1] = True
    slip = foot_slip(np.ones((2, 6, 4)), contact)
    assert np.isnan(slip[0]) and slip[1] == pytest.approx(1.0)


def test_cost_of_transport_by_hand():
    # 150 W on 15 kg at .5 m/s: 150 / (15 * 9.81 * .5)
    assert cost_of_transport(np.full((1, 10), 150.0), np.array([[0.3, 0.4]]), 15.0) == pytest.approx(2.0387, abs=1e-4)


def test_a_robot_that_stands_cannot_blow_the_cost_of_transport_up():
    power, velocity = np.array([[100.0], [100.0]]), np.array([[1.0, 0.0], [0.0, 0.0]])
    assert cost_of_transport(power, velocity, 10.0) == pytest.approx(200 / (10 * 9.81 * 1.0))
    assert cost_of_transport(power[1:], velocity[1:], 10.0) is None
    assert cost_of_transport(power[:0], velocity[:0], 10.0) is None
