"""Joint targets that reach the motors late."""

from __future__ import annotations

from dataclasses import replace

import torch

from camp.robots.go2 import GO2
from camp.sim.base import Dynamics, InitialState
from camp.sim.cpu import CpuSimulator
from camp.sim.delay import LONGEST_DELAY, DelayLine

CPU = torch.device("cpu")
POSE = torch.tensor(GO2.default_joint_position)


def constant(*values: float) -> torch.Tensor:
    """(N, 12) each robot's targets all the same."""
    return torch.tensor(values)[:, None].repeat(1, 12)


def test_targets_arrive_at_the_physics_step_that_is_due():
    """Control steps of four physics steps; robots 0, 1, 4 and 5 physics steps late."""
    line = DelayLine(4, 0.02, 0.005, CPU)
    delay = torch.tensor([0.0, 0.005, 0.02, 0.025])
    line.restart(torch.ones(4, dtype=torch.bool), constant(0.0, 0.0, 0.0, 0.0), delay)
    arrived = []
    for target in (1.0, 2.0):
        line.send(constant(*[target] * 4))
        arrived += [line.arrived(step)[:, 0] for step in range(4)]
    expected = [[1, 1, 1, 1, 2, 2, 2, 2], [0, 1, 1, 1, 1, 2, 2, 2], [0, 0, 0, 0, 1, 1, 1, 1], [0, 0, 0, 0, 0, 1, 1, 1]]
    torch.testing.assert_close(torch.stack(arrived, dim=1), torch.tensor(expected, dtype=torch.float32))


def test_a_restart_changes_no_other_robot():
    line = DelayLine(2, 0.02, 0.005, CPU)
    line.restart(torch.ones(2, dtype=torch.bool), constant(0.0, 0.0), torch.tensor([0.02, 0.02]))
    line.send(constant(1.0, 1.0))
    line.restart(torch.tensor([True, False]), constant(5.0, 5.0), torch.tensor([LONGEST_DELAY, 0.0]))
    for target, first in ((2.0, 5.0), (3.0, 5.0), (4.0, 5.0), (5.0, 5.0), (6.0, 5.0), (7.0, 2.0)):
        line.send(constant(target, target))
        torch.testing.assert_close(line.arrived(0)[:, 0], torch.tensor([first, target - 1.0]))


def make(delay: list[float]) -> CpuSimulator:
    num = len(delay)
    sim = CpuSimulator(GO2, num, control_period=0.02, physics_timestep=0.005, threads=1)
    sim.prepare(replace(Dynamics.nominal(num, 0.8, CPU), delay=torch.tensor(delay)))
    still = torch.zeros(num, 3)
    height = torch.tensor([[0.0, 0.0, GO2.standing_height]]).repeat(num, 1)
    upright = torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(num, 1)
    start = InitialState(height, upright, still, still, POSE.repeat(num, 1), torch.zeros(num, 12))
    sim.reset(torch.ones(num, dtype=torch.bool), start)
    return sim


def test_a_robot_without_delay_does_not_notice_those_with_one():
    alone, among = make([0.0]), make([0.0, 0.015])
    targets = POSE + 0.2 * torch.randn(10, 12, generator=torch.Generator().manual_seed(0))
    for target in targets:
        alone.step(target[None])
        among.step(target.repeat(2, 1))
    assert torch.equal(alone.state.qpos()[0], among.state.qpos()[0])
    assert not torch.allclose(among.state.qpos()[0], among.state.qpos()[1], atol=1e-3)


def test_motors_go_on_with_what_they_held_until_the_first_target_arrives():
    late, prompt = make([0.02]), make([0.0])
    held, start = POSE + 0.2, late.state
    late.reset(torch.tensor([True]), start, held[None])
    late.step(POSE[None] - 0.5)
    prompt.step(held[None])
    assert torch.equal(late.state.qpos(), prompt.state.qpos())


def test_targets_under_way_are_part_of_the_state():
    targets = POSE + 0.2 * torch.randn(12, 3, 12, generator=torch.Generator().manual_seed(1))
    straight, resumed = make([0.0, 0.01, 0.03]), make([0.0, 0.0, 0.0])
    for target in targets[:6]:
        straight.step(target)
    resumed.load_state_dict(straight.state_dict())
    for target in targets[6:]:
        straight.step(target)
        resumed.step(target)
    assert torch.equal(straight.state.qpos(), resumed.state.qpos())
