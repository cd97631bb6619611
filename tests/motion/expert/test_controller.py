"""MPC, swing legs and whole-body control on cases with a known answer."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from camp.gaits.schedule import GaitSchedule
from camp.motion.expert.controller import GaitController
from camp.motion.expert.expert import Expert
from camp.motion.expert.mpc import ForcePlan, ModelPredictiveController
from camp.motion.expert.swing import lift, minimum_jerk
from camp.robots.go2 import GO2

WEIGHT = 15.2064 * 9.81  # N


def standing(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = [0, 0, GO2.standing_height, 1, 0, 0, 0, *GO2.default_joint_position]
    mujoco.mj_forward(model, data)
    return data


@pytest.fixture
def controller() -> tuple[GaitController, mujoco.MjData]:
    model = GO2.load_torque_model()
    data = standing(model)
    # A stand longer than the MPC's horizon, so that its whole plan is standing.
    return GaitController(GO2, data, GaitSchedule("trot", 2.0), stand_duration=2.0), data


def test_standing_still_takes_a_quarter_of_the_weight_per_leg(
    controller: tuple[GaitController, mujoco.MjData],
) -> None:
    walker, data = controller
    target = walker.target
    mpc = ModelPredictiveController(walker.body, walker.parameters.mpc)
    robot = walker.read(data)
    plan = mpc.plan(target.state(target.time), robot.foot, target, walker.leg_momentum, np.zeros(3))
    assert plan.forces.shape == (20, 4, 3)
    np.testing.assert_allclose(plan.forces[:, :, 2], WEIGHT / 4, atol=3.0)  # the CoM is 2 mm behind the feet
    np.testing.assert_allclose(plan.forces[:, :, :2], 0.0, atol=3.0)
    np.testing.assert_allclose(plan.states[:, 3:6], np.tile(robot.srb[3:6], (21, 1)), atol=5e-3)


def test_mpc_pushes_back(controller: tuple[GaitController, mujoco.MjData]) -> None:
    walker, data = controller
    target, robot = walker.target, walker.read(data)
    mpc = ModelPredictiveController(walker.body, walker.parameters.mpc)
    pushed = target.state(target.time)
    pushed[9], pushed[5] = 0.3, pushed[5] - 0.02  # drifting ahead at .3 m/s, 2 cm too low
    first = mpc.plan(pushed, robot.foot, target, walker.leg_momentum, np.zeros(3)).forces[0].sum(axis=0)
    assert first[0] < -10.0
    assert first[2] > WEIGHT + 10.0


def test_plan_interpolates_states_and_holds_forces() -> None:
    states = np.repeat([[0.0], [1.0], [3.0]], 12, axis=1)
    forces = np.arange(2.0)[:, None, None] * np.ones((2, 4, 3))
    plan = ForcePlan(np.array([1.0, 1.5, 2.0]), states, forces)
    assert plan.state(1.25)[0] == pytest.approx(0.5)
    assert plan.state(1.75)[0] == pytest.approx(2.0)
    assert plan.force(1.4999)[0, 0] == 0.0
    assert plan.force(1.5)[0, 0] == 1.0
    assert plan.force(9.0)[0, 0] == 1.0


def test_stand_torques_hold_the_robot(controller: tuple[GaitController, mujoco.MjData]) -> None:
    walker, data = controller
    for _ in range(50):  # 1 s
        walker.plan(data, np.zeros(3))
        for _ in range(4):
            mujoco.mj_step1(data.model, data)
            data.ctrl[:] = walker.torque(data, 0.005)
            mujoco.mj_step2(data.model, data)
    contact = [data.sensor(f"{leg}_contact").data for leg in ("FL", "FR", "RL", "RR")]
    assert np.linalg.norm(np.sum(contact, axis=0)) == pytest.approx(WEIGHT, rel=0.05)
    assert data.qpos[2] == pytest.approx(GO2.standing_height, abs=0.02)
    assert np.abs(data.qvel[:6]).max() < 0.05


def test_torque_needs_a_plan(controller: tuple[GaitController, mujoco.MjData]) -> None:
    walker, data = controller
    with pytest.raises(RuntimeError, match="plan"):
        walker.torque(data, 0.005)


@pytest.mark.parametrize("profile", [minimum_jerk, lift])
def test_swing_profiles_are_consistent(profile: Callable[[float, float], tuple[float, float, float]]) -> None:
    duration, step = 0.25, 1e-5
    for fraction in (0.1, 0.4, 0.75):
        before, here, after = (profile(fraction + sign * step, duration) for sign in (-1, 0, 1))
        per_second = 2 * step * duration
        assert (after[0] - before[0]) / per_second == pytest.approx(here[1], rel=1e-4)
        assert (after[1] - before[1]) / per_second == pytest.approx(here[2], rel=1e-4)


def test_swing_profiles_begin_and_end_at_rest() -> None:
    assert minimum_jerk(0.0, 0.2) == (0.0, 0.0, 0.0)
    assert minimum_jerk(1.0, 0.2) == pytest.approx((1.0, 0.0, 0.0))
    assert lift(0.5, 0.2)[:2] == (1.0, 0.0)
    assert lift(0.0, 0.2)[:2] == lift(1.0, 0.2)[:2] == (0.0, 0.0)


def test_expert_predicts_what_its_targets_do() -> None:
    """The averaged inverse-PD target moves the learner's robot as the torques moved the copy."""
    model = GO2.load_model()
    data = standing(model)
    expert = Expert(GO2, data, GaitSchedule("trot", 2.0), stand_duration=0.2)
    worst = 0.0
    for _ in range(40):
        data.ctrl[:] = expert.answer(data, np.array([0.4, 0.0, 0.0]))
        for _ in range(4):
            mujoco.mj_step(model, data)
        worst = max(worst, np.abs(data.qpos[7:] - expert.predicted_joint_position).max())
    assert worst < 0.03  # rad after 20 ms
    assert expert.time == pytest.approx(0.6)
    assert expert.command[0] == pytest.approx(0.4)  # taken up at 1 m/s^2


def test_expert_leaves_the_robot_alone() -> None:
    model = GO2.load_model()
    data = standing(model)
    expert = Expert(GO2, data, GaitSchedule("pace", 3.0), stand_duration=0.2)
    before = np.r_[data.qpos, data.qvel, data.ctrl, data.qacc_warmstart, data.time]
    expert.answer(data, np.zeros(3))
    np.testing.assert_array_equal(np.r_[data.qpos, data.qvel, data.ctrl, data.qacc_warmstart, data.time], before)
