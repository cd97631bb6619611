"""What counts as physically impossible, judged in the float32 values that are used."""

from __future__ import annotations

import pytest
import torch

from camp.robots.go2 import GO2
from camp.sim.base import InitialState, RobotState
from camp.sim.cpu import CpuSimulator
from camp.sim.divergence import diverged, impossible, numbers, quantities


def standing(num: int = 3) -> RobotState:
    return InitialState(
        base_position=torch.tensor([[0.0, 0.0, GO2.standing_height]]).repeat(num, 1),
        base_quaternion=torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(num, 1),
        base_linear_velocity=torch.zeros(num, 3),
        base_angular_velocity=torch.zeros(num, 3),
        joint_position=torch.tensor(GO2.default_joint_position).repeat(num, 1),
        joint_velocity=torch.zeros(num, 12),
    ).robot_state()


def test_every_number_of_a_state_has_a_bound():
    assert numbers(standing()).shape[1] == len(quantities(GO2)) == 64 - 4
    assert all(one.low < 0.0 < one.high or "calf_joint" in one.name for one in quantities(GO2))


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("base_position", 1e8, "base x"),
        ("base_linear_velocity", 30.0, "base velocity x"),
        ("base_angular_velocity", -200.0, "base spin x"),
        ("joint_position", 5.0, "FL_hip_joint"),
        ("joint_velocity", 1e8, "FL_hip_joint speed"),
        ("joint_velocity", float("nan"), "FL_hip_joint speed"),
        ("foot_force", float("inf"), "force on FL_foot x"),
        ("body_force", 1e7, "force on base x"),
        ("base_quaternion", 1.5, "norm of the base quaternion"),
    ],
)
def test_one_impossible_number_is_enough(name, value, told):
    state = standing()
    assert not diverged(GO2, state).any() and impossible(GO2, state) == []
    getattr(state, name)[1].view(-1)[0] = value
    assert diverged(GO2, state).tolist() == [False, True, False]
    (line,) = impossible(GO2, RobotState(**{key: rows[1:] for key, rows in vars(state).items()}))
    assert line.startswith(told)


def test_what_overflows_float32_is_judged_as_used():
    state = standing()
    state.joint_velocity[1] = torch.full((12,), 1e200, dtype=torch.float64)  # finite in float64, infinite here
    assert diverged(GO2, state).tolist() == [False, True, False]


def test_random_targets_stay_possible():
    sim = CpuSimulator(GO2, 32, control_period=0.02, physics_timestep=0.005, threads=1)
    generator = torch.Generator().manual_seed(0)
    for step in range(60):
        if step % 3 == 0:
            target = 125.0 * torch.randn(32, 12, generator=generator)
        sim.step(target)
        assert not diverged(GO2, sim.state).any()


def test_a_violent_fall_is_possible():
    """The largest values that random targets led to (`camp.sim.divergence`)."""
    state = standing()
    state.base_position[1, 2], state.base_linear_velocity[1, 2], state.base_angular_velocity[1, 0] = 1.2, 4.9, 69.0
    state.joint_velocity[1] = torch.tensor([125.0, 143.0, 160.0] * 4)
    state.joint_position[1] = torch.tensor(GO2.joint_upper) + 1.4
    state.foot_force[1, 0, 2] = 6500.0
    assert not diverged(GO2, state).any()
