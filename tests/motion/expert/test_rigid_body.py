"""The single rigid body against mechanics worked by hand."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from camp.motion.expert.heading import advance_heading, approach_command
from camp.motion.expert.rigid_body import (
    Constraints,
    ContactPlan,
    RigidBody,
    force_response,
    free_response,
    friction_cone,
    measure_body,
    roll_pitch_yaw,
    skew,
    solve_qp,
    yaw_rotation,
)
from camp.robots.go2 import GO2

BODY = RigidBody(mass=10.0, inertia=np.diag([0.1, 0.4, 0.5]))


def test_skew_is_the_cross_product() -> None:
    a, b = np.array([1.0, -2.0, 3.0]), np.array([0.5, 4.0, -1.0])
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b))
    assert skew(np.ones((5, 3))).shape == (5, 3, 3)


def test_angles_of_a_rotation() -> None:
    np.testing.assert_allclose(roll_pitch_yaw(yaw_rotation(0.7)), [0.0, 0.0, 0.7], atol=1e-12)
    pitched = np.array([[np.cos(0.3), 0, np.sin(0.3)], [0, 1, 0], [-np.sin(0.3), 0, np.cos(0.3)]])
    np.testing.assert_allclose(roll_pitch_yaw(pitched), [0.0, 0.3, 0.0], atol=1e-12)


def test_free_fall() -> None:
    state = np.array([0, 0, 0, 0, 0, 1.0, 0, 0, 2.0, 0.5, 0, 3.0])
    after = free_response(state, np.array([0.2]), yaw=0.0)[0]
    np.testing.assert_allclose(after[2], 0.4)  # yaw at 2 rad/s
    np.testing.assert_allclose(after[3:6], [0.1, 0.0, 1.0 + 0.6 - 9.81 * 0.02])
    np.testing.assert_allclose(after[9:12], [0.5, 0.0, 3.0 - 9.81 * 0.2])


def test_force_through_the_lever() -> None:
    # 20 N up, .2 m ahead, for .1 s, then nothing for .1 s: dv = .2 m/s; moment -4 N m about y: dw = -1 rad/s.
    plan = ContactPlan(np.array([0.1, 0.1]), np.array([0]), np.array([0]), np.array([[0.2, 0.0, -0.3]]))
    states = force_response(BODY, plan, yaw=0.0) @ np.array([0.0, 0.0, 20.0])
    np.testing.assert_allclose(states[:, 11], [0.2, 0.2])
    np.testing.assert_allclose(states[:, 5], [0.01, 0.03])  # a t^2 / 2, then + .2 * .1
    np.testing.assert_allclose(states[:, 7], [-1.0, -1.0])
    np.testing.assert_allclose(states[:, 1], [-0.05, -0.15])


def test_response_turns_with_the_robot() -> None:
    lever, force, rotation = np.array([[0.2, 0.1, -0.3]]), np.array([3.0, -5.0, 20.0]), yaw_rotation(1.1)
    plan = ContactPlan(np.array([0.1]), np.array([0]), np.array([0]), lever)
    turned = ContactPlan(np.array([0.1]), np.array([0]), np.array([0]), lever @ rotation.T)
    straight = (force_response(BODY, plan, 0.0) @ force)[0]
    result = (force_response(BODY, turned, 1.1) @ (rotation @ force))[0]
    np.testing.assert_allclose(result[3:6], rotation @ straight[3:6])
    np.testing.assert_allclose(result[6:9], rotation @ straight[6:9])
    np.testing.assert_allclose(result[0:3], straight[0:3])  # angles are those of the yaw frame


@pytest.mark.parametrize(
    ("force", "inside"),
    [
        ([4.0, 0, 10], True),
        ([6.0, 0, 10], False),
        ([0, -6, 10], False),
        ([0, 0, 1], False),
        ([0, 0, 60], False),
    ],
)
def test_friction_cone(force: list[float], inside: bool) -> None:
    rows, bound = friction_cone(2, friction=0.5, lower=2.0, upper=50.0)
    assert rows.shape == (12, 6)
    assert bool((rows @ np.array([0, 0, 10, *force]) >= bound).all()) == inside


def test_quadratic_programme() -> None:
    # Nearest point to (2, 2) with x + y = 1 and x >= .8 is (.8, .2).
    constraints = Constraints(np.array([[1.0, 1.0], [1.0, 0.0]]), np.array([1.0, 0.8]), equalities=1)
    np.testing.assert_allclose(solve_qp(np.eye(2), -np.array([2.0, 2.0]), constraints), [0.8, 0.2])


def test_body_of_the_robot() -> None:
    model = GO2.load_torque_model()
    data = mujoco.MjData(model)
    data.qpos[:] = [0, 0, GO2.standing_height, np.cos(0.4), 0, 0, np.sin(0.4), *GO2.default_joint_position]
    mujoco.mj_forward(model, data)
    base = model.body("base").id
    body = measure_body(model, data, base)
    assert body.mass == pytest.approx(15.2, abs=0.05)  # the published link masses
    np.testing.assert_allclose(np.diag(body.inertia), [0.17, 0.48, 0.53], atol=0.01)


def test_heading_follows_an_arc() -> None:
    # A quarter circle of radius 1 m to the left.
    quarter = advance_heading(np.zeros(3), np.array([np.pi / 2, 0.0, np.pi / 2]), 1.0)
    np.testing.assert_allclose(quarter, [1.0, 1.0, np.pi / 2], atol=1e-12)
    sideways = advance_heading(np.array([0, 0, np.pi / 2]), np.array([0.0, 1.0, 0.0]), 0.5)
    np.testing.assert_allclose(sideways, [-0.5, 0.0, np.pi / 2], atol=1e-12)
    back = advance_heading(advance_heading(np.ones(3), np.array([0.3, 0.1, 0.5]), 2.0), np.array([0.3, 0.1, 0.5]), -2.0)
    np.testing.assert_allclose(back, np.ones(3))


def test_command_is_approached_in_steps() -> None:
    step = approach_command(np.zeros(3), np.array([1.0, -0.01, 0.0]), np.full(3, 0.02))
    np.testing.assert_allclose(step, [0.02, -0.01, 0.0])
