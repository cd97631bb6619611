"""The bare loop walks as the environment does, and explains itself where it cannot."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from camp import deploy
from camp.build import load_run
from camp.common.errors import CampError
from camp.common.paths import policies_root
from camp.deployment.export import export_policy
from camp.deployment.loop import observe
from camp.evaluation.controllers import NetworkController, robot_of
from camp.evaluation.plan import Planner
from camp.evaluation.policies import contract_of_run
from camp.evaluation.recording import Recording, record
from camp.evaluation.rollout import Setting, roll_out
from camp.gaits.skills import performed
from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait
from camp.motion.clips.sampler import ReferenceStates
from tests.errors import assert_one_line
from tests.evaluation.suites import evaluation
from tests.small_run import small_run

onnx = pytest.importorskip("onnx", reason="comes with the export extra")
pytest.importorskip("onnxruntime", reason="comes with the export extra")

COMMANDS = [[0.6, 0.0, 0.0], [-0.2, 0.2, 0.5]]
SHIPPED = policies_root() / "go2_camp"


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    return small_run(tmp_path_factory.mktemp("run"), ["env.observation.history=2"])


@pytest.fixture(scope="module")
def policy(run) -> deploy.Policy:
    return deploy.Policy(export_policy(run, run).model)


def evaluated(run: Path, seconds: float) -> Recording:
    """Every skill at every command in the evaluation's environment."""
    loaded = load_run(run)
    contract = contract_of_run("run", loaded.config)
    wanted = evaluation("duration_s=5", f"commands={COMMANDS}", "video_command=0")
    references = ReferenceStates(loaded.clips, contract.skill_set)
    plan = Planner(wanted, robot_of(contract), contract.skill_set, contract.control_period_s, None, references).grid()
    plan.skill = plan.skill[:, : round(seconds / contract.control_period_s)]
    setting = Setting(contract.control_period_s, robot_of(contract), wanted.noise, 1.0, seed=0, threads=1)
    (trace,) = roll_out([(plan, NetworkController(contract, loaded.actor))], setting)
    return record(trace)


def test_the_bare_loop_goes_where_the_environment_goes(run, policy):
    recording, skills = evaluated(run, 1.0), policy.metadata["skills"]
    moved = 0.0
    for row, (skill, command) in enumerate((skill, command) for skill in skills for command in COMMANDS):
        done = deploy.walk(policy, skill, command, 1.0)
        steps = int(recording.steps_upright[row])
        assert done.fell == bool(recording.fallen[row]) and len(done.qpos) == steps + done.fell
        assert steps > 25  # half a second, lest nothing be compared
        np.testing.assert_allclose(done.qpos[:steps], recording.qpos[row, :steps], atol=1e-4)
        np.testing.assert_allclose(done.joint_target[:steps], recording.joint_target[row, :steps], atol=1e-4)
        np.testing.assert_allclose(done.velocity[:steps], recording.velocity[row, :steps], atol=1e-3)
        assert (done.contact[:steps] == recording.contact[row, 3::4][:steps]).mean() > 0.99
        moved = max(moved, float(np.ptp(done.qpos[:steps, 7:], axis=0).max()))
    assert moved > 0.1  # rad: not a robot that stands still


def test_observation_is_in_the_order_that_the_metadata_name(policy):
    robot = deploy.Robot(policy.metadata)
    rotation = np.array([np.cos(0.1), 0.0, np.sin(0.1), 0.0])  # nose down by .2 rad
    robot.data.qpos[3:7] = rotation
    robot.data.qvel[3:6] = [0.1, 0.2, 0.3]
    robot.data.qpos[7:] = np.arange(12)
    robot.data.qvel[6:] = np.arange(12, 24)
    last_action, command = np.full(12, 0.5, np.float32), np.array([0.6, -0.1, 0.2], np.float32)
    found = observe(policy, robot, command, policy.one_hot("bound"), last_action)
    assert found.dtype == np.float32
    expected = [
        *(0.1, 0.2, 0.3),
        *(np.sin(0.2), 0.0, -np.cos(0.2)),
        *command,
        *(np.arange(12) - [0.0, 0.9, -1.8] * 4),
        *np.arange(12, 24),
        *last_action,
        *(0, 0, 1, 0),
    ]
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_joints_and_gains_are_taken_by_name(policy):
    names = policy.metadata["joint_names"][::-1]
    robot = deploy.Robot(
        policy.metadata
        | {"joint_names": names, "default_pose": [-1.8, 0.9, 0.0] * 4, "kp": list(range(1, 13)), "kd": [0.5] * 12}
    )
    assert robot.joint_position[names.index("RR_calf_joint")] == pytest.approx(-1.8)
    hip = robot.model.actuator("FL_hip_joint").id
    assert robot.model.actuator_gainprm[hip, 0] == 12.0
    assert robot.model.actuator_biasprm[hip, :3].tolist() == [0.0, -12.0, -0.5]
    assert robot.data.ctrl[hip] == 0.0 and robot.data.ctrl[robot.model.actuator("FL_calf_joint").id] == -1.8


def test_the_robot_starts_on_its_feet(policy):
    robot = deploy.Robot(policy.metadata)
    feet = [robot.data.geom(f"{leg}_foot").xpos[2] for leg in deploy.FOOT_NAMES]
    assert min(feet) == pytest.approx(0.022)
    assert robot.gravity.tolist() == [0.0, 0.0, -1.0] and not robot.fallen
    robot.hold(np.array([0.0, 0.9, -1.8] * 4, np.float32))
    assert robot.data.time == pytest.approx(0.02)


def test_a_robot_on_its_side_has_fallen(policy):
    robot = deploy.Robot(policy.metadata)
    robot.data.qpos[3:7] = [np.cos(0.45), np.sin(0.45), 0.0, 0.0]  # .9 rad of roll
    assert robot.fallen


def test_a_policy_without_skill_input_is_given_zeros(tmp_path):
    run = small_run(tmp_path / "run", ["env.observe_skill=false"])
    blind = deploy.Policy(export_policy(run, run).model)
    assert blind.one_hot("pace").tolist() == [0.0] * 4
    recording = evaluated(run, 0.3)
    done = deploy.walk(blind, "pace", COMMANDS[0], 0.3)
    np.testing.assert_allclose(done.qpos, recording.qpos[len(COMMANDS)], atol=1e-4)


def test_the_loop_needs_little_of_camp():
    tree = ast.parse(Path(deploy.__file__).read_text())
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module}
    assert {name for name in modules if name.startswith("camp")} == {
        "camp.common.arguments",
        "camp.common.errors",
        "camp.metrics.contact",
        "camp.metrics.gait",
        "camp.deployment.loop",
        "camp.deployment.simulated",
        "camp.robots.quadruped",
    }


def test_the_command_as_it_is_typed(policy, run):
    arguments = [str(run / "policy.onnx"), "--skill", "trot", "--command", "0.6", "0", "0", "--seconds", "4"]
    command = [sys.executable, "-m", "camp.deploy", *arguments]
    done = subprocess.run(command, env=os.environ | {"OMP_NUM_THREADS": "1"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    asked, shown = done.stdout.splitlines()
    assert asked == "asked:     trot at 0.60 0.00 m/s 0.00 rad/s" and shown.startswith("performed: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{run}/policy.onnx", "--skill", "walk"], "skill 'walk': unknown to this policy; choose one of trot, pace"),
        (["{run}/none.onnx", "--skill", "trot"], "none.onnx: not found; write it with `python -m camp.export"),
        (["{run}/config.yaml", "--skill", "trot"], "config.yaml: not a readable ONNX file; export it again"),
        (["{run}/policy.onnx", "--skill", "trot", "--seconds", "1"], "--seconds 1: choose 4 or more"),
        (["{run}/policy.onnx", "--skill", "trot", "--seconds", "nan"], "--seconds nan: choose 4 or more"),
        (["{run}/policy.onnx", "--skill", "trot", "--seconds", "inf"], "--seconds inf: choose 4 or more"),
        (["{run}/policy.onnx", "--skill", "trot", "--command", "nan", "0", "0"], "--command nan 0.0 0.0: give three"),
        (["{run}/policy.onnx", "--skill", "trot", "--command", "0", "inf", "0"], "--command 0.0 inf 0.0: give three"),
        (["{run}/policy.onnx", "--skill", "trot", "--command", "0.6"], "--command: expected 3 arguments; see --help"),
        (["{run}/policy.onnx"], "the following arguments are required: --skill; see --help"),
    ],
)
def test_input_that_cannot_be_used_is_one_line(policy, run, capfd, arguments, message):
    assert deploy.main([argument.format(run=run) for argument in arguments]) == 2
    captured = capfd.readouterr()
    assert_one_line(captured.err, message)


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("command_range", '{"vx_m_s": [1, 0]}', "not [low, high] of vx_m_s, vy_m_s, yaw_rate_rad_s"),
        ("kp", None, "metadata kp: missing"),
        ("kp", "30, 30", "metadata kp = '30, 30': not JSON"),
        ("kp", "[30, 30]", "metadata kp = [30, 30]: not 12 finite numbers"),
        ("kd", json.dumps([1.0] * 11 + [float("nan")]), "holds NaN, which is no number"),
        ("action_scale", "0", "metadata action_scale = 0: not a finite number above 0"),
        ("joint_names", json.dumps(["FL_hip"] * 12), "not the robot's 12 joints"),
        ("skills", "3", "metadata skills = 3: not a list of names"),
        ("history", "0", "metadata history = 0: not a number from 1 to 100"),
        ("observe_skill", '"no"', "metadata observe_skill = 'no': not true or false"),
        ("observation", "{}", "metadata observation = {}: not a list of entries"),
        (
            "observation",
            '[{"name": "gyro", "size": 3}]',
            "none of what this loop reads from its robot (base_angular",
        ),
        ("observation", '[{"name": "gravity", "size": 4}]', "its size is not 3"),
        ("observation", '[{"name": "gravity", "size": 3}]', "maps [('obs', [98]), ('joint_target', [12])]"),
        ("control_period", "0.022", "metadata control_period = 0.022: no multiple of the physics timestep, 0.005 s"),
        ("control_period", "0.001", "metadata control_period = 0.001: no multiple of the physics timestep, 0.005 s"),
        ("control_period", "-0.02", "metadata control_period = -0.02: not in (0, 0.1] s"),
        ("control_period", "60", "metadata control_period = 60: not in (0, 0.1] s"),
    ],
)
def test_metadata_that_cannot_be_used_are_one_line(policy, run, tmp_path, capfd, key, text, message):
    model = onnx.load(run / "policy.onnx")
    properties = {entry.key: entry.value for entry in model.metadata_props} | {key: text}
    onnx.helper.set_model_props(model, {name: value for name, value in properties.items() if value is not None})
    onnx.save(model, tmp_path / "policy.onnx")
    assert deploy.main([str(tmp_path / "policy.onnx"), "--skill", "trot"]) == 2
    captured = capfd.readouterr()
    assert_one_line(captured.err, message)


def test_an_answer_that_is_no_number_is_an_error(run, tmp_path):
    model = onnx.load(run / "policy.onnx")
    bias = next(one for one in model.graph.initializer if one.name.endswith("bias"))
    bias.CopyFrom(onnx.numpy_helper.from_array(np.full(bias.dims, np.nan, np.float32), bias.name))
    onnx.save(model, tmp_path / "policy.onnx")
    with pytest.raises(CampError, match="the policy's target for FL_hip_joint is not finite: its weights are damaged"):
        deploy.walk(deploy.Policy(tmp_path / "policy.onnx"), "trot", COMMANDS[0], 0.1)


def test_a_command_beyond_the_range_of_training_is_clipped_and_told_once(policy, run, capsys, monkeypatch):
    assert policy.within_range([2.0, 0.0, -0.7]) == [0.9, 0.0, -0.6] and policy.within_range([0.6, 0.2, 0.0]) == [
        *(0.6, 0.2, 0.0)
    ]
    walks = []
    monkeypatch.setattr(
        deploy, "walk", lambda *given: walks.append(given[2]) or deploy.Walk(*[np.zeros((9, 3))] * 4, True)
    )
    for command in (["2", "0", "0"], ["0.6", "0", "0"]):
        assert deploy.main([str(run / "policy.onnx"), "--skill", "trot", "--command", *command]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert walks == [[0.9, 0.0, 0.0], [0.6, 0.0, 0.0]]
    assert lines[0] == "command:   2 0 0 is beyond what the policy was trained for; 0.9 0 0 is asked for"
    assert lines[1] == "asked:     trot at 0.90 0.00 m/s 0.00 rad/s" and lines[3].startswith("asked: ")


def test_a_policy_without_a_range_takes_any_command(policy, monkeypatch):
    monkeypatch.delitem(policy.metadata, "command_range")
    assert policy.within_range([2.0, 0.0, 0.0]) == [2.0, 0.0, 0.0]


def test_a_diverging_simulation_is_an_error_without_a_log_file(policy, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    robot = deploy.Robot(policy.metadata)
    robot.data.qvel[:] = np.nan
    with pytest.raises(CampError, match="the robot's state is not finite: the simulation diverged"):
        robot.hold(robot.joint_position)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_shipped_policy_performs_its_gaits_in_the_bare_loop(tmp_path):
    """Labels and stride frequencies, at every third of the evaluation's commands (docs/deployment.md has them all)."""
    loaded = load_run(SHIPPED)
    report = json.loads((SHIPPED / "eval.json").read_text())
    policy, period = deploy.Policy(export_policy(SHIPPED, tmp_path).model), loaded.config.env.control_period_s
    with np.load(SHIPPED / "eval.npz", allow_pickle=False) as arrays:
        commands, contacts, upright = arrays["commands"].tolist(), arrays["contact"], arrays["steps_upright"]
    first, skills = round(report["discard_s"] / period), loaded.config.motion.skill_set()
    right, differing, deviations = [], [], []

    def label_of(contact: np.ndarray, fell: bool) -> tuple[str, float]:
        gait = measure_gait(debounced(contact[None, first:], period), period)
        return "fell" if fell else performed(gait.label, gait.frequency_hz, skills)[0], float(gait.frequency_hz[0])

    for k, skill in enumerate(loaded.skills):
        for g in range(0, len(commands), 3):
            done = deploy.walk(policy, skill, commands[g], report["duration_s"])
            label, hertz = label_of(done.contact, done.fell)
            evaluated, evaluated_hertz = label_of(contacts[k, g], bool(upright[k, g] < contacts.shape[2]))
            right.append((label == skill, evaluated == skill))
            if label == evaluated:
                deviations.append(abs(hertz - evaluated_hertz))
            else:
                differing.append((skill, commands[g], label))
    assert len(differing) <= 1, differing  # a label on the edge may flip
    assert np.nanmax(deviations) <= 0.05  # Hz
    in_the_loop, in_the_evaluation = np.mean(right, axis=0)
    assert abs(in_the_loop - in_the_evaluation) <= 0.025
