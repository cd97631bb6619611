"""Torques and heights of feet against MuJoCo's own."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import torch

from camp.envs.measurement import foot_height, measure
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES
from camp.sim.base import Dynamics, InitialState
from camp.sim.motors import MotorLaw


@pytest.fixture
def data() -> mujoco.MjData:
    """A robot in the air in an odd pose, everything moving, joint targets .3 rad off."""
    rng = np.random.default_rng(0)
    data = mujoco.MjData(GO2.load_model())
    quaternion = np.array([0.9, 0.2, -0.3, 0.1])
    joints = np.array(GO2.default_joint_position) + rng.uniform(-0.3, 0.3, 12)
    data.qpos[:] = np.concatenate([[0, 0, 1.0], quaternion / np.linalg.norm(quaternion), joints])
    data.qvel[:] = rng.uniform(-2.0, 2.0, 18)
    data.ctrl[:] = joints + rng.uniform(-0.3, 0.3, 12)
    mujoco.mj_forward(data.model, data)
    return data


def state_of(data: mujoco.MjData):
    qpos, qvel = (torch.tensor(value, dtype=torch.float32)[None] for value in (data.qpos, data.qvel))
    parts = (qpos[:, :3], qpos[:, 3:7], qvel[:, :3], qvel[:, 3:6], qpos[:, 7:], qvel[:, 6:])
    return InitialState(*parts).robot_state()


def test_torque_is_that_of_the_model(data):
    state = state_of(data)
    law = MotorLaw.of(GO2, Dynamics.nominal(1, 0.8, torch.device("cpu")))
    target = torch.tensor(data.ctrl, dtype=torch.float32)[None]
    torque = law.torque(target, state.joint_position, state.joint_velocity)
    np.testing.assert_allclose(torque[0], data.actuator_force, atol=1e-4)


def test_weak_motors_and_the_limit_count():
    dynamics = Dynamics.nominal(1, 0.8, torch.device("cpu"))
    dynamics.motor_strength[:] = 0.5
    law = MotorLaw.of(GO2, dynamics)
    torque = law.torque(torch.full((1, 12), 1.0), torch.zeros(1, 12), torch.full((1, 12), 2.0))
    assert torque[0, :3].tolist() == pytest.approx([14.0, 14.0, 19.0])  # .5 (30 - 2), .5 (40 - 2)
    assert law.torque(torch.full((1, 12), 9.0), *torch.zeros(2, 1, 12)).max() == pytest.approx(45.43)


def test_foot_height_is_that_of_the_lowest_point_of_the_sphere(data):
    expected = [data.geom(f"{leg}_foot").xpos[2] - GO2.leg.foot_radius for leg in FOOT_NAMES]
    np.testing.assert_allclose(foot_height(GO2, measure(GO2, state_of(data)))[0], expected, atol=1e-5)
