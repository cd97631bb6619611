"""The model against the published robot, and the closed-form kinematics against MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import torch

from camp.robots import go2
from camp.robots.kinematics import foot_jacobian, foot_position, foot_velocity, inverse_kinematics

MODEL = go2.load_model()


def random_joints(count: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.uniform(go2.JOINT_LOWER, go2.JOINT_UPPER, (count, go2.NUM_JOINTS))


def mujoco_feet(joints: np.ndarray, base: np.ndarray | None = None) -> np.ndarray:
    data = mujoco.MjData(MODEL)
    data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0] if base is None else base
    data.qpos[7:] = joints
    mujoco.mj_kinematics(MODEL, data)
    feet = np.array([data.geom(f"{leg}_foot").xpos for leg in go2.FOOT_NAMES])
    return (feet - data.body("base").xpos) @ data.body("base").xmat.reshape(3, 3)


def test_total_mass_and_limits():
    assert MODEL.body_mass.sum() == pytest.approx(6.921 + 4 * (0.678 + 1.152 + 0.241352))
    assert [MODEL.actuator(i).name for i in range(12)] == list(go2.JOINT_NAMES)
    assert [MODEL.joint(name).qposadr[0] for name in go2.JOINT_NAMES] == list(range(7, 19))
    np.testing.assert_allclose(MODEL.actuator_forcerange[:, 1], go2.TORQUE_LIMIT)
    np.testing.assert_allclose(MODEL.actuator_gainprm[:, 0], go2.PD_GAIN_P)
    np.testing.assert_allclose(-MODEL.actuator_biasprm[:, 2], go2.PD_GAIN_D)
    np.testing.assert_allclose(MODEL.jnt_range[1:].T, [go2.JOINT_LOWER, go2.JOINT_UPPER])


def test_left_and_right_legs_mirror_each_other():
    for kind in ("hip", "thigh", "calf"):
        for left, right in (("FL", "FR"), ("RL", "RR")):
            a, b = MODEL.body(f"{left}_{kind}"), MODEL.body(f"{right}_{kind}")
            np.testing.assert_allclose(a.inertia, b.inertia, rtol=1e-9)
            np.testing.assert_allclose(a.ipos * [1, -1, 1], b.ipos, atol=1e-12)
            np.testing.assert_allclose(a.pos * [1, -1, 1], b.pos, atol=1e-12)


def test_forward_kinematics_matches_mujoco():
    joints = random_joints(200)
    expected = np.stack([mujoco_feet(q) for q in joints])
    np.testing.assert_allclose(foot_position(torch.from_numpy(joints)).numpy(), expected, atol=1e-6)


def test_forward_kinematics_is_in_the_base_frame():
    joints = random_joints(1, seed=3)[0]
    quaternion = np.array([0.8, -0.3, 0.4, 0.33])
    base = np.concatenate([[1.0, -2.0, 0.5], quaternion / np.linalg.norm(quaternion)])
    np.testing.assert_allclose(foot_position(torch.from_numpy(joints)).numpy(), mujoco_feet(joints, base), atol=1e-6)


def test_jacobian_matches_autograd():
    joints = torch.from_numpy(random_joints(1, seed=1)[0])
    full = torch.autograd.functional.jacobian(foot_position, joints)  # (4, 3, 12)
    analytic = foot_jacobian(joints)
    for leg in range(4):
        torch.testing.assert_close(analytic[leg], full[leg, :, 3 * leg : 3 * leg + 3], atol=1e-10, rtol=0)


def test_foot_velocity_is_the_time_derivative():
    q, v = torch.from_numpy(random_joints(1, seed=4)), torch.from_numpy(random_joints(1, seed=5))
    h = 1e-6
    difference = (foot_position(q + h * v) - foot_position(q - h * v)) / (2 * h)
    torch.testing.assert_close(foot_velocity(q, v), difference, atol=1e-6, rtol=0)


def test_inverse_kinematics_inverts_in_the_walking_range():
    rng = np.random.default_rng(2)
    low, high = np.array([-0.7, -0.3, -2.6] * 4), np.array([0.7, 2.0, -0.85] * 4)
    joints = torch.from_numpy(rng.uniform(low, high, (300, 12)))
    torch.testing.assert_close(inverse_kinematics(foot_position(joints)), joints, atol=1e-6, rtol=0)


def test_inverse_kinematics_out_of_reach_stretches_toward_the_target():
    feet = foot_position(torch.tensor(go2.DEFAULT_JOINT_POSITION, dtype=torch.float64))
    far = feet + torch.tensor([0.0, 0.0, -1.0], dtype=torch.float64)
    reached = foot_position(inverse_kinematics(far))
    assert torch.isfinite(reached).all()
    assert (reached[..., 2] < -0.42).all()


def test_standing_pose_touches_the_ground_and_holds():
    data = mujoco.MjData(MODEL)
    mujoco.mj_resetDataKeyframe(MODEL, data, MODEL.key("stand").id)
    mujoco.mj_kinematics(MODEL, data)
    lowest = min(data.geom(f"{leg}_foot").xpos[2] for leg in go2.FOOT_NAMES) - go2.FOOT_RADIUS
    assert 0.0 <= lowest < 0.02
    for _ in range(400):
        mujoco.mj_step(MODEL, data)
    assert data.qpos[2] > 0.2 and data.body("base").xmat[8] > 0.95
    force = sum(np.linalg.norm(data.sensor(f"{leg}_contact").data) for leg in go2.FOOT_NAMES)
    assert force == pytest.approx(MODEL.body_mass.sum() * 9.81, rel=0.02)


def test_torque_model_has_motors():
    model = go2.load_torque_model()
    data = mujoco.MjData(model)
    data.ctrl[:] = 1.0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.actuator_force, 1.0)
