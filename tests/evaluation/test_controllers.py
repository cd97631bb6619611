"""Contracts: what a network is shown, and what its answer means."""

from __future__ import annotations

import json
import math
from dataclasses import asdict

import pytest
import torch

from camp.build import build_env
from camp.common.errors import CampError
from camp.envs.measurement import measure
from camp.evaluation.contract import Contract, Output, Term, parse_skill, read_contract
from camp.evaluation.controllers import NetworkController, OpenLoopSine, Sight, Standing, robot_of
from camp.evaluation.policies import contract_of_run
from camp.gaits.skills import Skill
from camp.robots.go2 import GO2
from camp.robots.quadruped import JOINT_NAMES
from camp.sim.base import InitialState


def sight(num: int = 2, time_s: float = 0.0) -> Sight:
    """Robots in some state."""
    draw = torch.Generator().manual_seed(0)

    def some(width: int) -> torch.Tensor:
        return torch.randn(num, width, generator=draw)

    quaternion = some(4)
    state = InitialState(
        some(3), quaternion / quaternion.norm(dim=1, keepdim=True), some(3), some(3), some(12), some(12)
    )
    skill = torch.arange(num) % 2
    return Sight(measure(GO2, state.robot_state()), some(3), skill, time_s)


def contract(**changes) -> Contract:
    values = {
        "contract": 1,
        "name": "foreign",
        "robot": "go2",
        "control_period_s": 0.02,
        "joint_names": list(JOINT_NAMES),
        "default_pose": [0.0, 0.9, -1.8] * 4,
        "kp": [30.0] * 12,
        "kd": [1.0] * 12,
        "output": Output(scale=0.25, offset=[0.0, 0.9, -1.8] * 4),
        "observation": [Term("gravity"), Term("skill")],
        "skills": {"trot_2hz": [1.0, 0.0], "pronk_3hz": [0.0, 1.0]},
        "command_range": {"vx_m_s": (-1, 1), "vy_m_s": (-1, 1), "yaw_rate_rad_s": (-1, 1)},
    }
    return Contract(**(values | changes))


class Echo:
    """Remembers observations and answers with a ramp."""

    def __init__(self):
        self.seen = []

    def __call__(self, observation: torch.Tensor) -> torch.Tensor:
        self.seen.append(observation)
        return torch.arange(12.0).expand(len(observation), -1)


def started(found: Contract, held: torch.Tensor | None = None) -> tuple[NetworkController, Echo]:
    echo = Echo()
    controller = NetworkController(found, echo)
    controller.start(torch.tensor(GO2.default_joint_position).expand(2, -1) if held is None else held)
    return controller, echo


def test_a_policy_of_camp_sees_what_it_sees_in_training(config, clips):
    env = build_env(config, clips, num_envs=2)
    try:
        env.reset(seed=3, options={"stagger": False})
        found = contract_of_run("camp", config)
        command, skill = torch.tensor([[0.5, 0.0, 0.1], [0.2, -0.1, 0.0]]), torch.tensor([0, 3])
        pose, action = torch.tensor(GO2.default_joint_position), torch.full((2, 12), 0.1)
        controller, echo = started(found, pose + config.robot.action_scale * action)
        env.advance(action)
        expected = env.set_command(command, skill)
        target = controller(Sight(measure(GO2, env.sim.state), command, skill, 0.02))
    finally:
        env.close()
    torch.testing.assert_close(echo.seen[0], expected)
    torch.testing.assert_close(target[0], pose + config.robot.action_scale * torch.arange(12.0))


def test_scale_offset_and_clip_of_a_term():
    controller, echo = started(
        contract(observation=[Term("command", scale=[2, 2, 0.25], offset=0.1, clip=(-0.2, 0.2))])
    )
    seen = sight()
    controller(seen)
    expected = ((seen.command - 0.1) * torch.tensor([2, 2, 0.25])).clamp(-0.2, 0.2)
    torch.testing.assert_close(echo.seen[0], expected)


def test_joints_are_in_the_policys_order():
    order = list(JOINT_NAMES[::-1])
    observation = [Term("joint_position"), Term("joint_velocity"), Term("last_action")]
    controller, echo = started(contract(joint_names=order, default_pose=[0.1] * 12, observation=observation))
    seen = sight()
    target = controller(seen)
    position = seen.measurement.joint_position.flip(1) - 0.1
    torch.testing.assert_close(echo.seen[0][:, :12], position)
    torch.testing.assert_close(echo.seen[0][:, 12:24], seen.measurement.joint_velocity.flip(1))
    offset = torch.tensor([0.0, 0.9, -1.8] * 4)
    torch.testing.assert_close(target[0].flip(0), offset + 0.25 * torch.arange(12.0))
    controller(seen)
    torch.testing.assert_close(echo.seen[1][:, 24:], torch.arange(12.0).expand(2, -1))
    robot = robot_of(contract(joint_names=order, kp=list(map(float, range(12)))))
    assert robot.pd_gain_p == tuple(map(float, range(11, -1, -1)))


@pytest.mark.parametrize("newest", [True, False])
@pytest.mark.parametrize("layout", ["frames", "terms"])
def test_history(newest, layout):
    order = "newest_first" if newest else "oldest_first"
    found = contract(observation=[Term("time"), Term("command")], history=3, history_order=order, history_layout=layout)
    controller, echo = started(found)
    for step in range(3):
        controller(sight(time_s=0.02 * step))
    times = [0.04, 0.02, 0.0] if newest else [0.0, 0.02, 0.04]
    columns = [0, 4, 8] if layout == "frames" else [0, 1, 2]
    assert echo.seen[2][0, columns].tolist() == pytest.approx(times)
    assert echo.seen[0][0, columns].tolist() == [0.0] * 3  # the first frame fills the history
    assert echo.seen[2].shape == (2, 12) and found.observation_size == 12


def test_the_phase_runs_at_the_skills_own_frequency():
    controller, echo = started(contract(observation=[Term("phase")]))
    controller(sight(time_s=0.1))  # trot at 2 Hz, pronk at 3 Hz
    angle = 2 * math.pi * 0.1 * torch.tensor([2.0, 3.0])
    torch.testing.assert_close(echo.seen[0], torch.stack([angle.sin(), angle.cos()], dim=1))


def test_baselines_know_nothing():
    pose = torch.tensor(GO2.default_joint_position).expand(2, -1)
    standing, sine = Standing(GO2), OpenLoopSine(GO2, [Skill("trot", 2.0), Skill("pronk", 3.0)])
    for controller in (standing, sine):
        controller.start(pose)
    torch.testing.assert_close(standing(sight()), pose)
    moved = sine(sight(time_s=0.125))[0].view(4, 3) - pose[0].view(4, 3)  # a quarter stride at 2 Hz
    torch.testing.assert_close(moved[:, 1], 0.15 * torch.tensor([1.0, -1.0, -1.0, 1.0]))
    torch.testing.assert_close(moved[:, 2], -2 * moved[:, 1])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robot": "spot"}, "robot = 'spot': choose one of go2, a1"),
        ({"contract": 2}, "contract: Input should be 1"),
        ({"kp": [30.0]}, "kp: give 12 finite numbers"),
        ({"joint_names": ["FL_hip"] * 12}, "joint_names: give the robot's 12 joints"),
        ({"control_period_s": 0.022}, "control_period_s = 0.022: choose a multiple of the physics step"),
        ({"control_period_s": 1.0}, "control_period_s = 1: choose 0.005 to 0.1 s"),
        ({"skills": {"walk": [1.0]}}, "skill 'walk' is none of the judge's"),
        ({"skills": {"trot_fast": [1.0]}}, "skill 'trot_fast' is none of the judge's"),
        ({"skills": {"trot_0hz": [1.0]}}, "skill 'trot_0hz': write a frequency above 0"),
        ({"skills": {"trot": [1.0], "pace": [0.0, 1.0]}}, "skills: give encodings of one length"),
        ({"skills": {}}, "give one entry or more"),
        ({"observation": [{"term": "gyro"}]}, "observation: term 'gyro' is unknown; choose from base_angular"),
        ({"observation": [{"term": "gravity", "scale": [1.0]}]}, "scale of gravity has 1 numbers: give one, or 3"),
        ({"observation": [{"term": "gravity", "scala": 1.0}]}, "observation.0.scala: Unexpected keyword argument"),
        ({"observation": [{"term": "phase"}], "skills": {"trot": [1.0]}}, "the term phase needs skills with a freq"),
        ({"output": {"scale": [1.0, 2.0]}}, "output: scale has 2 numbers: give one, or 12"),
        ({"history": 0}, "history = 0: give 1 or more"),
        ({"gains": 3}, "gains: Unexpected keyword argument"),
    ],
)
def test_a_wrong_contract_is_one_line(changes, message, tmp_path):
    path = tmp_path / "contract.json"
    path.write_text(json.dumps(asdict(contract()) | changes))
    with pytest.raises(CampError) as caught:
        read_contract(path)
    assert message in str(caught.value) and "\n" not in str(caught.value) and str(path) in str(caught.value)


def test_a_contract_survives_its_file(tmp_path):
    (tmp_path / "contract.json").write_text(json.dumps(asdict(contract())))
    assert read_contract(tmp_path / "contract.json") == contract()
    (tmp_path / "contract.json").write_text("{")
    with pytest.raises(CampError, match="Invalid JSON"):
        read_contract(tmp_path / "contract.json")
    with pytest.raises(CampError, match="No such file"):
        read_contract(tmp_path / "none.json")


def test_skills_by_name():
    assert parse_skill("trot") == Skill("trot") and parse_skill("pace_2.5hz") == Skill("pace", 2.5)
