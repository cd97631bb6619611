"""Every robot against its model, and the closed-form kinematics against MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import torch

from camp import dataset
from camp.common.errors import ConfigError
from camp.config.compose import compose_config
from camp.robots.a1 import A1
from camp.robots.go2 import GO2
from camp.robots.kinematics import foot_jacobian, foot_position, foot_velocity
from camp.robots.quadruped import FOOT_NAMES, GRAVITY, JOINT_NAMES, NUM_LEGS
from camp.robots.registry import DEFAULT_ROBOT, ROBOTS, find_robot
from camp.robots.robot import Robot
from camp.sim.base import LINK_NAMES
from tests.errors import assert_one_line
from tests.robots.checks import mujoco_feet, random_joints


@pytest.fixture(params=list(ROBOTS.values()), ids=list(ROBOTS))
def robot(request) -> Robot:
    return request.param


def test_joints_gains_and_limits_are_those_of_the_model(robot):
    model = robot.load_spec().compile()
    assert [model.actuator(i).name for i in range(model.nu)] == list(JOINT_NAMES)
    assert [model.joint(name).qposadr[0] for name in JOINT_NAMES] == list(range(7, 19))
    np.testing.assert_allclose(model.actuator_forcerange[:, 1], robot.torque_limit)
    np.testing.assert_allclose(-model.actuator_forcerange[:, 0], robot.torque_limit)
    np.testing.assert_allclose(model.actuator_gainprm[:, 0], robot.pd_gain_p)
    np.testing.assert_allclose(-model.actuator_biasprm[:, 2], robot.pd_gain_d)
    np.testing.assert_allclose(model.jnt_range[1:].T, [robot.joint_lower, robot.joint_upper])
    np.testing.assert_allclose(model.opt.gravity, [0, 0, -GRAVITY])
    assert model.body_mass.sum() == pytest.approx(robot.mass, abs=0.05)


def test_bodies_geoms_and_sensors_have_their_names(robot):
    model = robot.load_model()
    assert model.body("payload").parentid == model.body("base").id and model.body("payload").mass == 0.0
    for name in LINK_NAMES:
        assert model.body(name).mass > 0.0
    for leg in FOOT_NAMES:
        foot = model.geom(f"{leg}_foot")
        assert foot.bodyid == model.body(f"{leg}_foot").id and foot.priority == 1
        assert foot.type == mujoco.mjtGeom.mjGEOM_SPHERE and foot.size[0] == robot.leg.foot_radius
    thighs = [f"{leg}_thigh_contact" for leg in FOOT_NAMES]
    sensors = [model.sensor(i).name for i in range(model.nsensor)]
    assert sensors == [*(f"{leg}_contact" for leg in FOOT_NAMES), "base_contact", *thighs]
    assert model.nsensordata == 3 * model.nsensor
    assert model.camera("track").id >= 0


def test_left_and_right_legs_mirror_each_other(robot):
    model = robot.load_model()
    for kind in ("hip", "thigh", "calf"):
        for left, right in (("FL", "FR"), ("RL", "RR")):
            a, b = model.body(f"{left}_{kind}"), model.body(f"{right}_{kind}")
            np.testing.assert_allclose(a.inertia, b.inertia, rtol=1e-9)
            np.testing.assert_allclose(a.ipos * [1, -1, 1], b.ipos, atol=1e-12)
            np.testing.assert_allclose(a.pos * [1, -1, 1], b.pos, atol=1e-12)


def test_forward_kinematics_matches_mujoco(robot):
    joints, model = random_joints(robot, 200), robot.load_model()
    expected = np.stack([mujoco_feet(model, q) for q in joints])
    np.testing.assert_allclose(foot_position(robot.leg, torch.from_numpy(joints)).numpy(), expected, atol=1e-6)


def test_forward_kinematics_is_in_the_base_frame(robot):
    joints = random_joints(robot, 1, seed=3)[0]
    quaternion = np.array([0.8, -0.3, 0.4, 0.33])
    base = np.concatenate([[1.0, -2.0, 0.5], quaternion / np.linalg.norm(quaternion)])
    expected = mujoco_feet(robot.load_model(), joints, base)
    np.testing.assert_allclose(foot_position(robot.leg, torch.from_numpy(joints)).numpy(), expected, atol=1e-6)


def test_jacobian_matches_autograd(robot):
    joints = torch.from_numpy(random_joints(robot, 1, seed=1)[0])
    full = torch.autograd.functional.jacobian(lambda q: foot_position(robot.leg, q), joints)  # (4, 3, 12)
    analytic = foot_jacobian(robot.leg, joints)
    for leg in range(4):
        torch.testing.assert_close(analytic[leg], full[leg, :, 3 * leg : 3 * leg + 3], atol=1e-10, rtol=0)


def test_foot_velocity_is_the_time_derivative(robot):
    q, v = (torch.from_numpy(random_joints(robot, 1, seed=seed)) for seed in (4, 5))
    h = 1e-6
    difference = (foot_position(robot.leg, q + h * v) - foot_position(robot.leg, q - h * v)) / (2 * h)
    torch.testing.assert_close(foot_velocity(robot.leg, q, v), difference, atol=1e-6, rtol=0)


def test_standing_pose_touches_the_ground_and_holds(robot):
    model = robot.load_model()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("stand").id)
    assert data.qpos[2] == robot.standing_height
    np.testing.assert_array_equal(data.qpos[7:], robot.default_joint_position)
    np.testing.assert_array_equal(data.ctrl, robot.default_joint_position)
    mujoco.mj_kinematics(model, data)
    lowest = min(data.geom(f"{leg}_foot").xpos[2] for leg in FOOT_NAMES) - robot.leg.foot_radius
    assert 0.0 <= lowest < 0.005
    for _ in range(400):
        mujoco.mj_step(model, data)
    assert data.qpos[2] > 0.7 * robot.standing_height and data.body("base").xmat[8] > 0.95
    upward = -sum(data.sensor(f"{leg}_contact").data[2] for leg in FOOT_NAMES)  # of the ground on the robot
    assert upward == pytest.approx(model.body_mass.sum() * GRAVITY, rel=0.02)


def test_torque_model_has_motors(robot):
    model = robot.load_torque_model()
    data = mujoco.MjData(model)
    data.ctrl[:] = 1.0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.actuator_force, 1.0)


def test_the_go2_is_as_published():
    assert GO2.load_model().body_mass.sum() == pytest.approx(6.921 + 4 * (0.678 + 1.152 + 0.241352))
    assert GO2.torque_limit == (23.7, 23.7, 45.43) * NUM_LEGS
    assert GO2.leg.thigh_length == GO2.leg.calf_length == 0.213


def test_the_a1_is_as_published():
    """Numbers of a1_description, and places of the front left foot worked out from them."""
    model = A1.load_model()
    assert model.body_mass.sum() == pytest.approx(6.0 + 4 * (0.595 + 0.888 + 0.151 + 0.06))
    assert np.degrees(A1.joint_lower[:3]) == pytest.approx([-46.0, -60.0, -154.5], abs=1e-5)
    assert np.degrees(A1.joint_upper[:3]) == pytest.approx([46.0, 240.0, -52.5], abs=1e-5)
    straight_down, sideways = (0.0, 0.9, -1.8), (0.5, 0.0, -np.pi / 2)
    for pose, foot in (
        (straight_down, (0.1805, 0.047 + 0.0838, -0.4 * np.cos(0.9))),
        (
            sideways,
            (
                0.1805 + 0.2,
                0.047 + 0.0838 * np.cos(0.5) + 0.2 * np.sin(0.5),
                0.0838 * np.sin(0.5) - 0.2 * np.cos(0.5),
            ),
        ),
    ):
        np.testing.assert_allclose(mujoco_feet(model, np.tile(pose, 4))[0], foot, atol=1e-9)


def test_the_a1s_calf_carries_the_foot_of_the_description():
    """Two bodies, calf (.151 kg) and foot (a ball of .06 kg), lumped: mass, centre and inertia about the knee."""
    calf = A1.load_model().body("FL_calf")
    centre, foot = np.array([0.007105, -0.000239, -0.096933]), np.array([0.0, 0.0, -0.2])
    assert calf.mass[0] == pytest.approx(0.211)
    np.testing.assert_allclose(calf.ipos, (0.151 * centre + 0.06 * foot) / 0.211, atol=1e-7)
    about_y = 0.002360755 + 0.151 * (centre[0] ** 2 + centre[2] ** 2) + 0.4 * 0.06 * 0.02**2 + 0.06 * 0.2**2
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, calf.iquat)
    axes = turn.reshape(3, 3)
    arm = calf.ipos
    about_knee = axes @ np.diag(calf.inertia) @ axes.T + calf.mass[0] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    assert about_knee[1, 1] == pytest.approx(about_y, rel=1e-6)


def test_motors_push_no_harder_than_their_limit(robot):
    model = robot.load_model()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("stand").id)
    data.ctrl[:] = np.array(robot.default_joint_position) + 9.0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.actuator_force, robot.torque_limit)


def test_the_robot_is_chosen_by_its_name():
    assert find_robot("go2") is GO2 and DEFAULT_ROBOT == "go2"
    assert find_robot("a1") is A1 and compose_config(["robot=a1", "run=cpu"]).robot.name == "a1"
    assert compose_config([]).robot.name == compose_config(["robot=go2_soft", "run=scratch"]).robot.name == "go2"
    with pytest.raises(ConfigError, match=r"^robot\.name = 'spot': unknown robot; choose one of go2"):
        compose_config(["robot.name=spot"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--robot", "spot"], "--robot = 'spot': unknown robot; choose one of go2"),
        (["--robot", "spot", "validate"], "--robot = 'spot': unknown robot"),
        (["validate", "--robot", "spot"], "--robot = 'spot': unknown robot"),
        (["perturbed", "--robot", "spot"], "--robot = 'spot': unknown robot"),
        (["--only", "gallop_*"], "--only 'gallop_*': fits no clip"),
    ],
)
def test_a_robot_or_clip_that_does_not_exist_is_one_line(arguments, message, capfd):
    assert dataset.main(arguments) == 2
    assert_one_line(capfd.readouterr().err, message)
