"""Another robot goes through everything: no number of the Go2 is left in the code."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import torch

from camp import deploy
from camp.build import build_env, build_robot, expert_clips
from camp.common.errors import CampError, ClipError
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.deployment.export import metadata
from camp.deployment.metadata import read_metadata
from camp.envs.measurement import measure
from camp.envs.observations import position
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.contract import contract_on
from camp.evaluation.controllers import Standing, robot_of
from camp.evaluation.evaluator import Evaluator, Subject
from camp.evaluation.policies import contract_of_metadata, contract_of_run
from camp.evaluation.suite import stamp
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clips, save_clip
from camp.motion.dataset.generate import generate_clip
from camp.motion.dataset.requests import ClipRequest, shipped_requests
from camp.motion.dataset.validate import check_clip
from camp.motion.exchange.convert import import_motion
from camp.motion.exchange.exporter import export_amp
from camp.motion.exchange.motion import ImportOptions
from camp.robots import registry
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES
from camp.robots.robot import Robot
from camp.sim.base import Dynamics, InitialState
from camp.sim.cpu import CpuSimulator
from camp.sim.motors import MotorLaw
from camp.training.imitation_data import imitation_data
from camp.training.warm_start import _expert_version
from tests.robots.checks import mujoco_feet
from tests.robots.second import SECOND, second_robot

CPU = torch.device("cpu")


@pytest.fixture(scope="module")
def robot(tmp_path_factory) -> Iterator[Robot]:
    """In the registry while this module's tests run."""
    robot = second_robot(tmp_path_factory.mktemp(SECOND))
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(registry.ROBOTS, SECOND, robot)
        yield robot


@pytest.fixture(scope="module")
def clip(robot) -> Clip:
    """One second of a trot."""
    return generate_clip(robot, ClipRequest("trot", 3.0, (0.4, 0.0, 0.0)), steps=50)


@pytest.fixture(scope="module")
def config(robot, clip, tmp_path_factory) -> Config:
    folder = tmp_path_factory.mktemp("clips")
    save_clip(folder / "trot.npz", clip)
    quiet = [f"env.{part}.enabled=false" for part in ("noise", "push", "randomization")]
    own = [f"robot.name={SECOND}", "robot.kp=[35,35,45]", "robot.kd=[1.2,1.2,1.2]", f"motion.folder={folder}"]
    skill = ["motion.skills=[trot]", "motion.frequencies_hz=[3]", "sim=cpu", "sim.threads=1", "sim.num_envs=3"]
    return compose_config(["run=smoke", *own, *skill, *quiet])


def test_it_differs_from_the_go2_in_everything(robot):
    assert not [field.name for field in fields(Robot) if getattr(robot, field.name) == getattr(GO2, field.name)]
    assert not [name for name, value in vars(GO2.leg).items() if getattr(robot.leg, name) == value]


def test_the_configuration_names_it(robot, config):
    assert build_robot(config.robot) == robot
    assert build_robot(replace(config.robot, kp=[1.0, 2.0, 3.0])) == replace(robot, pd_gain_p=(1.0, 2.0, 3.0) * 4)


def test_the_simulator_steps_its_model(robot):
    sim = CpuSimulator(robot, 2, control_period=0.02, physics_timestep=0.005, threads=1)
    model = robot.load_spec().compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("stand").id)
    pose = torch.tensor(robot.default_joint_position)
    for target in pose + 0.1 * torch.randn(10, 2, 12, generator=torch.Generator().manual_seed(0)):
        sim.step(target)
        data.ctrl[:] = target[1].numpy()
        mujoco.mj_step(model, data, 4)
    np.testing.assert_allclose(sim.state.qpos()[1], data.qpos, atol=1e-6)


def test_the_environment_measures_its_feet_and_stands_it_on_the_ground(robot, config):
    env = build_env(config, expert_clips(config))
    env.config.initialization.reference_fraction = 0.0
    env.config.initialization.joint_position_scale = [1.0, 1.0]
    observation, _ = env.reset(seed=0, options={"stagger": False})
    np.testing.assert_allclose(env.sim.state.joint_position, [robot.default_joint_position] * 3, rtol=1e-6)
    assert observation[:, position(env.observer.actor_entries, "joint_position")].abs().max() < 1e-6
    feet = mujoco_feet(robot.load_model(), np.array(robot.default_joint_position))
    np.testing.assert_allclose(env.sim.state.base_position[:, 2] + feet[:, 2].min(), robot.leg.foot_radius, atol=1e-6)
    for _ in range(5):
        result = env.advance(torch.randn(3, 12, generator=torch.Generator().manual_seed(1)))
    joints = env.sim.state.joint_position
    expected = np.stack([mujoco_feet(robot.load_model(), q) for q in joints.double().numpy()])
    np.testing.assert_allclose(measure(env.robot, env.sim.state).foot_position, expected, atol=1e-5)
    np.testing.assert_allclose(result.transition[:, 1, -12:].reshape(3, 4, 3), expected, atol=1e-5)
    env.close()


def test_the_expert_walks_it(robot, clip):
    failed = [str(check) for check in check_clip(robot, clip) if not check.passed]
    assert failed == []
    assert np.ptp(clip.base_position[:, 0]) > 0.3 and clip.foot_contact.mean() == pytest.approx(0.5, abs=0.1)
    feet = np.stack([mujoco_feet(robot.load_model(), q) for q in clip.joint_position.astype(np.float64)])
    np.testing.assert_allclose(clip.foot_position, feet, atol=1e-5)
    assert np.abs(feet[..., 1]).mean() == pytest.approx(robot.leg.hip_y + robot.leg.hip_offset, abs=0.02)


def test_its_clips_are_not_those_of_the_go2(robot, config):
    folder = Path(str(config.motion.folder))
    assert len(load_clips(robot, folder, ["trot"])) == 1
    with pytest.raises(ClipError, match="foot off its leg"):
        load_clips(GO2, folder, ["trot"])


def test_pushes_are_those_for_its_mass(robot):
    own, other = (
        [np.linalg.norm(push.force) for one in shipped_requests(of) for push in one.pushes] for of in (robot, GO2)
    )
    np.testing.assert_allclose(np.array(own) / np.array(other), robot.mass / GO2.mass, rtol=5e-3)


def test_imported_motion_stands_on_its_legs(robot, clip, tmp_path):
    export_amp(tmp_path / "motion.txt", clip)
    back = import_motion(tmp_path / "motion.txt", "amp", ImportOptions(robot, gait="trot", frequency_hz=3.0))
    np.testing.assert_allclose(back.foot_position, clip.foot_position, atol=1e-4)
    with pytest.raises(ClipError, match="from those of a Unitree Go2"):
        import_motion(tmp_path / "motion.txt", "amp", ImportOptions(GO2, gait="trot", frequency_hz=3.0))


def test_imitation_counts_from_its_pose(robot, clip, config):
    data = imitation_data([clip], config, CPU)
    expected = (clip.joint_target[1:] - np.array(robot.default_joint_position)) / config.robot.action_scale
    np.testing.assert_allclose(data.action, expected, atol=1e-5)


def test_perturbed_clips_of_two_robots_do_not_mix(robot):
    versions = {
        _expert_version(one, ("trot",)) for one in (GO2, robot, replace(robot, mass=17.0), replace(robot, title="x"))
    }
    assert len(versions) == 3  # the title alone changes no clip


def test_its_motors_have_its_limits(robot):
    law = MotorLaw.of(robot, Dynamics.nominal(1, 0.8, CPU))
    assert law.torque(torch.full((1, 12), 9.0), *torch.zeros(2, 1, 12))[0].tolist() == list(robot.torque_limit)


def test_it_is_judged_on_its_own_model(robot, config):
    for contract in (contract_of_run("x", config), contract_of_metadata("x", metadata(config))):
        assert robot_of(contract) == robot and contract.default_pose == list(robot.default_joint_position)
    assert stamp(compose_evaluation(), robot).name == "custom"  # whose model no suite names


def test_the_judges_baselines_stand_in_its_pose(robot, config):
    contract, held = contract_of_run("x", config), torch.zeros(2, 12)
    standing = Standing(robot_of(contract))
    standing.start(held)
    sight: Any = None
    torch.testing.assert_close(standing(sight)[1], torch.tensor(robot.default_joint_position))
    torch.testing.assert_close(
        InitialState.standing(robot.load_model(), 2, CPU).joint_position[0], torch.tensor(robot.default_joint_position)
    )


def test_the_judge_stands_it_on_its_feet(robot, clip, config):
    values = ["suite=short", "duration_s=3", "discard_s=1", "walks.per_skill=2", "threads=1", "baselines=false"]
    values += ["parts=[gait,tracking,quality,reference]", "commands=[[0.4,0,0]]", "video_command=0"]
    subject = Subject("x", contract_of_run("x", config), lambda: Standing(robot))
    report = Evaluator(compose_evaluation(values), [clip]).judge(subject).report
    assert (report.suite.robot, report.suite.name) == (SECOND, "custom")
    assert report.policies["trained"].all.falls == 0 and report.policies["trained"].all.rollouts == 2
    quality = report.quality["all"]
    assert quality.torque_at_limit_share == 0.0 and 0.0 < quality.peak_torque_share < 0.5


def test_a_policy_can_be_judged_on_another_robot_than_its_own(robot, config):
    other = contract_on(contract_of_run("x", config), "go2")
    assert other.name == "x_on_go2" and robot_of(other) == replace(
        GO2, pd_gain_p=robot.pd_gain_p, pd_gain_d=robot.pd_gain_d
    )
    assert other.default_pose == list(robot.default_joint_position)


def test_an_exported_policy_names_it(robot, config):
    described = metadata(config)
    assert described["robot"] == SECOND and described["default_pose"] == list(robot.default_joint_position)
    assert described["kp"] == list(robot.pd_gain_p)
    written = {key: json.dumps(value) for key, value in described.items()}
    walker = deploy.Robot(read_metadata(written))
    feet = [walker.data.geom(f"{leg}_foot").xpos[2] for leg in FOOT_NAMES]
    assert min(feet) == pytest.approx(robot.leg.foot_radius)


def test_a_policy_of_an_unknown_robot_is_refused_and_an_older_one_is_a_go2(config):
    written = {key: json.dumps(value) for key, value in metadata(config).items()}
    del written["robot"]
    assert read_metadata(written)["robot"] == "go2"
    with pytest.raises(CampError, match=r"metadata robot = 'spot': not one of go2"):
        read_metadata(written | {"robot": '"spot"'})
