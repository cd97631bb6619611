"""Rotations, the AMP state and the task rewards, worked by hand or against MuJoCo."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import torch

from camp.envs.measurement import measure, rotate, rotate_inverse
from camp.motion.clips.clip import amp_state
from camp.robots.amp_state import AMP_STATE_SIZE
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES
from camp.sim.base import RobotState


def test_quarter_turn_about_z_maps_forward_to_left():
    quaternion = torch.tensor([[math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]])
    torch.testing.assert_close(rotate(quaternion, torch.tensor([[1.0, 0, 0]])), torch.tensor([[0.0, 1, 0]]))
    torch.testing.assert_close(rotate_inverse(quaternion, torch.tensor([[0.0, 1, 0]])), torch.tensor([[1.0, 0, 0]]))


def test_rotation_agrees_with_mujoco():
    rng = np.random.default_rng(0)
    for _ in range(20):
        quaternion, vector, expected = rng.standard_normal(4), rng.standard_normal(3), np.zeros(3)
        quaternion /= np.linalg.norm(quaternion)
        mujoco.mju_rotVecQuat(expected, vector, quaternion)
        result = rotate(torch.from_numpy(quaternion)[None], torch.from_numpy(vector)[None])
        np.testing.assert_allclose(result[0].numpy(), expected, atol=1e-12)


def state_of(qpos: np.ndarray, qvel: np.ndarray) -> RobotState:
    q, v = torch.from_numpy(qpos).float()[None], torch.from_numpy(qvel).float()[None]
    return RobotState(
        q[:, :3],
        q[:, 3:7],
        v[:, :3],
        v[:, 3:6],
        q[:, 7:],
        v[:, 6:],
        torch.zeros(1, 4, 3),
        torch.zeros(1, 5, 3),
        torch.zeros(1, 4),
    )


def test_measurement_agrees_with_mujoco():
    model = GO2.load_model()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    data.qpos[:] = np.concatenate(
        [[0.3, -0.2, 0.4], rng.standard_normal(4), rng.uniform(GO2.joint_lower, GO2.joint_upper)]
    )
    data.qpos[3:7] /= np.linalg.norm(data.qpos[3:7])
    data.qvel[:] = rng.standard_normal(18)
    mujoco.mj_forward(model, data)
    measured = measure(GO2, state_of(data.qpos, data.qvel))
    velocity = np.zeros(6)
    # Body-centred velocity in the body's own axes; MuJoCo puts rotation first. Origin, not centre of mass.
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, model.body("base").id, velocity, 1)
    np.testing.assert_allclose(measured.angular_velocity[0].numpy(), velocity[:3], atol=1e-5)
    np.testing.assert_allclose(measured.linear_velocity[0].numpy(), velocity[3:], atol=1e-5)
    rotation = data.body("base").xmat.reshape(3, 3)
    np.testing.assert_allclose(measured.gravity[0].numpy(), rotation.T @ [0, 0, -1], atol=1e-6)
    feet = np.array([data.geom(f"{leg}_foot").xpos for leg in FOOT_NAMES])
    np.testing.assert_allclose(measured.foot_position[0].numpy(), (feet - data.qpos[:3]) @ rotation, atol=1e-5)


def test_amp_state_of_a_clip_is_the_environments(clips):
    """Discriminators compare the two: the same state must give the same 43 numbers, in the same order."""
    clip, row = clips[0], 17
    position = np.concatenate([clip.base_position[row], clip.base_quaternion[row], clip.joint_position[row]])
    world_velocity = rotate(
        torch.from_numpy(clip.base_quaternion[row])[None],
        torch.from_numpy(clip.base_linear_velocity[row])[None],
    )[0].numpy()
    velocity = np.concatenate([world_velocity, clip.base_angular_velocity[row], clip.joint_velocity[row]])
    state = measure(GO2, state_of(position, velocity)).amp_state()[0].numpy()
    assert state.shape == (AMP_STATE_SIZE,)
    np.testing.assert_allclose(state, amp_state(clip)[row], atol=2e-5)
