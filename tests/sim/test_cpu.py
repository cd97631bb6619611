"""The CPU simulator against a plain MuJoCo loop, and its handling of resets, dynamics and divergence."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import torch

from camp.robots.go2 import GO2
from camp.sim.base import Dynamics, InitialState
from camp.sim.cpu import CpuSimulator
from camp.sim.divergence import diverged

POSE = torch.tensor(GO2.default_joint_position)


def make(num_envs: int = 4) -> CpuSimulator:
    return CpuSimulator(GO2, num_envs, control_period=0.02, physics_timestep=0.005, threads=1)


def standing(num: int, height: float = GO2.standing_height) -> InitialState:
    return InitialState(
        base_position=torch.tensor([[0.0, 0.0, height]]).repeat(num, 1),
        base_quaternion=torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(num, 1),
        base_linear_velocity=torch.zeros(num, 3),
        base_angular_velocity=torch.zeros(num, 3),
        joint_position=POSE.repeat(num, 1),
        joint_velocity=torch.zeros(num, 12),
    )


def test_step_equals_a_plain_mujoco_loop():
    sim = make()
    targets = POSE + 0.2 * torch.randn(20, 4, 12, generator=torch.Generator().manual_seed(0))
    data = mujoco.MjData(sim.model)
    mujoco.mj_resetDataKeyframe(sim.model, data, sim.model.key("stand").id)
    for target in targets:
        sim.step(target)
        data.ctrl[:] = target[2].numpy()
        mujoco.mj_step(sim.model, data, 4)
    np.testing.assert_allclose(sim.state.joint_position[2].numpy(), data.qpos[7:], atol=1e-6)
    np.testing.assert_allclose(sim.state.base_position[2].numpy(), data.qpos[:3], atol=1e-6)


def test_standing_robot_is_carried_by_its_feet():
    sim = make()
    for _ in range(150):
        sim.step(POSE.repeat(4, 1))
    weight = sim.model.body_mass.sum() * 9.81
    torch.testing.assert_close(sim.state.foot_force[..., 2].sum(1), torch.full((4,), weight), rtol=0.02, atol=0)
    assert (sim.state.body_force == 0).all()


def test_foot_stance_counts_the_physics_steps_of_a_control_step():
    sim = make(1)
    dropped = standing(1, height=GO2.standing_height + 0.002)  # falls for 20 ms, then bounces into its stance
    sim.reset(torch.tensor([True]), dropped)
    assert (sim.state.foot_stance == 0).all()
    data, seen = mujoco.MjData(sim.model), []
    data.qpos[:], data.ctrl[:] = dropped.qpos()[0].numpy(), POSE.numpy()
    for _ in range(5):
        loaded = np.zeros(4)
        for _ in range(4):
            mujoco.mj_step(sim.model, data)
            loaded += np.linalg.norm(data.sensordata[:12].reshape(4, 3), axis=1) > 1.0
        sim.step(POSE[None])
        seen.append(sim.state.foot_stance[0])
        np.testing.assert_allclose(seen[-1].numpy(), loaded / 4)
    assert any(((one > 0) & (one < 1)).any() for one in seen) and (seen[-1] == 1).all()


def test_fallen_robot_is_felt_by_its_base():
    sim = make(1)
    upside_down = standing(1, height=0.15)
    upside_down.base_quaternion = torch.tensor([[0.0, 1.0, 0.0, 0.0]])
    sim.reset(torch.tensor([True]), upside_down)
    for _ in range(50):
        sim.step(POSE[None])
    assert sim.state.body_force[0].norm(dim=-1).max() > 1.0


def test_subset_reset_leaves_the_others_alone():
    sim = make()
    for _ in range(5):
        sim.step(POSE.repeat(4, 1) + 0.1)
    before = sim.state
    sim.reset(torch.tensor([False, True, False, True]), standing(4, height=0.5))
    after = sim.state
    for name in ("base_position", "joint_position", "joint_velocity", "foot_force"):
        torch.testing.assert_close(getattr(after, name)[[0, 2]], getattr(before, name)[[0, 2]], atol=0, rtol=0)
    torch.testing.assert_close(after.base_position[[1, 3], 2], torch.tensor([0.5, 0.5]))
    assert (after.foot_force[[1, 3]] == 0).all()


def dynamics(num: int) -> Dynamics:
    return Dynamics.nominal(num, 0.8, torch.device("cpu"))


def set_dynamics(sim: CpuSimulator, changed: Dynamics) -> None:
    """Everyone standing, with other physical parameters."""
    sim.prepare(changed)
    sim.reset(torch.ones(sim.num_envs, dtype=torch.bool), standing(sim.num_envs))


def test_payload_and_link_mass_change_the_total_mass():
    sim = make(3)
    changed = dynamics(3)
    changed.payload_mass[1] = 3.0
    changed.link_mass_scale[2] = 1.2
    set_dynamics(sim, changed)
    nominal = sim.model.body_mass.sum()
    total = [sim._batch.get_model(env).body_subtreemass[0] for env in range(3)]
    np.testing.assert_allclose(total, [nominal, nominal + 3.0, nominal * 1.2], rtol=1e-6)


def test_payload_weighs_on_the_feet():
    sim = make(2)
    changed = dynamics(2)
    changed.payload_mass[1] = 1.0
    set_dynamics(sim, changed)
    weight = torch.zeros(2)
    for step in range(50):
        sim.step(POSE.repeat(2, 1))
        if step >= 25:  # the mean of the swing around rest, before a loaded robot sinks onto its calves
            weight += sim.state.foot_force[..., 2].sum(1) / 25
    assert 0.5 < (weight[1] - weight[0]) / 9.81 < 1.5


def test_payload_position_shifts_the_load():
    sim = make(2)
    changed = dynamics(2)
    changed.payload_mass[:] = 3.0
    changed.payload_position[0] = torch.tensor([0.0, 0.1, 0.0])
    changed.payload_position[1] = torch.tensor([0.0, -0.1, 0.0])
    set_dynamics(sim, changed)
    for _ in range(150):
        sim.step(POSE.repeat(2, 1))
    left_minus_right = (sim.state.foot_force[..., 2] * torch.tensor([1.0, -1.0, 1.0, -1.0])).sum(1)
    assert left_minus_right[0] > 5.0 and left_minus_right[1] < -5.0


def test_friction_decides_whether_a_pushed_robot_slides():
    sim = make(2)
    changed = dynamics(2)
    changed.friction[:] = torch.tensor([0.05, 1.5])
    set_dynamics(sim, changed)
    for _ in range(100):
        sim.step(POSE.repeat(2, 1))
    start = sim.state.base_position[:, 1].clone()
    sim.push(torch.tensor([[0.0, 0.8, 0.0]]).repeat(2, 1))
    for _ in range(40):
        sim.step(POSE.repeat(2, 1))
    moved = (sim.state.base_position[:, 1] - start).abs()
    assert moved[0] > 3 * moved[1]


def test_gains_and_motor_strength_scale_the_torque():
    sim = make(4)
    changed = dynamics(4)
    changed.kp_scale[1] = 0.8
    changed.kd_scale[2] = 1.2
    changed.motor_strength[3] = 0.5
    set_dynamics(sim, changed)
    expected = {0: (30.0, 1.0), 1: (24.0, 1.0), 2: (30.0, 1.2), 3: (15.0, 0.5)}
    for env, (kp, kd) in expected.items():
        model = sim._batch.get_model(env)
        assert model.actuator_gainprm[0, 0] == pytest.approx(kp)
        assert -model.actuator_biasprm[0, 1] == pytest.approx(kp)
        assert -model.actuator_biasprm[0, 2] == pytest.approx(kd)
        assert model.actuator_forcerange[0, 1] == pytest.approx(23.7)


def test_divergence_stays_visible_until_reset():
    sim = make(3)
    second = torch.tensor([False, True, False])
    broken = standing(3)
    broken.joint_velocity[:] = float("nan")
    sim.reset(second, broken)
    for _ in range(3):
        sim.step(POSE.repeat(3, 1))
    assert diverged(GO2, sim.state).tolist() == [False, True, False]
    sim.reset(second, standing(3))
    sim.step(POSE.repeat(3, 1))
    assert not diverged(GO2, sim.state).any()
    torch.testing.assert_close(sim.state.joint_position[1], sim.state.joint_position[1].nan_to_num())


def test_state_dict_continues_bit_for_bit():
    targets = POSE + 0.2 * torch.randn(12, 4, 12, generator=torch.Generator().manual_seed(1))
    straight, resumed = make(), make()
    for target in targets[:6]:
        straight.step(target)
    resumed.load_state_dict(straight.state_dict())
    torch.testing.assert_close(resumed.state.foot_force, straight.state.foot_force, atol=0, rtol=0)
    for target in targets[6:]:
        straight.step(target)
        resumed.step(target)
    end, same = straight.state_dict(), resumed.state_dict()
    for name, rows in (end | end.pop("delays")).items():
        assert torch.equal(rows, (same | same["delays"])[name]), name
