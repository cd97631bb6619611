"""policy.onnx answers as torch does and says how it wants to be spoken to."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch
import yaml

from camp.build import Run, build_env, load_run
from camp.cli.key_values import run_command
from camp.config.compose import compose_config
from camp.deployment import onnx_graph
from camp.deployment.export import JointTargets, export_policy, metadata
from camp.deployment.onnx_graph import ExportError, policy_graph
from camp.export import export
from camp.robots.go2 import GO2
from tests.small_run import environment_observations, small_run

onnx = pytest.importorskip("onnx", reason="comes with the export extra")
onnxruntime = pytest.importorskip("onnxruntime", reason="comes with the export extra")


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    return small_run(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def loaded(run) -> Run:
    return load_run(run)


@pytest.fixture(scope="module")
def exported(run, tmp_path_factory) -> Path:
    """The folder with policy.onnx and policy.json."""
    folder = tmp_path_factory.mktemp("exported")
    export_policy(run, folder)
    return folder


def answer(exported: Path, observation: torch.Tensor) -> torch.Tensor:
    session = onnxruntime.InferenceSession(str(exported / "policy.onnx"), providers=["CPUExecutionProvider"])
    return torch.from_numpy(session.run(["joint_target"], {"obs": observation.numpy()})[0])


def torch_answer(loaded: Run, observation: torch.Tensor) -> torch.Tensor:
    """default pose + k a, written out."""
    with torch.no_grad():
        return torch.tensor([0.0, 0.9, -1.8] * 4) + 0.25 * loaded.actor(observation)


@pytest.mark.parametrize("rows", [1, 3, 500])
def test_parity_on_random_observations(loaded, exported, rows):
    observation = 3.0 * torch.randn(rows, 49, generator=torch.Generator().manual_seed(rows))
    assert (answer(exported, observation) - torch_answer(loaded, observation)).abs().max() <= 1e-5


def test_parity_on_the_environments_observations(loaded, exported):
    env = build_env(loaded.config, loaded.clips)
    observation = environment_observations(env)
    env.close()
    found = answer(exported, observation)
    assert (found - torch_answer(loaded, observation)).abs().max() <= 1e-5
    assert (found - torch.tensor([0.0, 0.9, -1.8] * 4)).abs().max() > 0.1  # a policy that answers


def test_parity_far_outside_where_inputs_are_clipped(loaded, exported):
    observation = torch.full((2, 49), 1e3) * torch.tensor([[1.0], [-1.0]])
    found = answer(exported, observation)
    torch.testing.assert_close(found, torch_answer(loaded, observation), rtol=1e-5, atol=1e-5)
    torch.testing.assert_close(found, answer(exported, 10 * observation), rtol=0, atol=0)


def test_file_is_valid_and_whole(exported):
    model = onnx.load(exported / "policy.onnx", load_external_data=False)
    onnx.checker.check_model(model, full_check=True)
    assert not any(tensor.external_data for tensor in model.graph.initializer)
    assert sorted(path.name for path in exported.iterdir()) == ["policy.json", "policy.onnx"]
    (obs,), (target,) = model.graph.input, model.graph.output
    shapes = [[d.dim_param or d.dim_value for d in value.type.tensor_type.shape.dim] for value in (obs, target)]
    assert (obs.name, target.name) == ("obs", "joint_target") and shapes == [["N", 49], ["N", 12]]


def test_metadata_are_those_of_the_robot(exported):
    found = json.loads((exported / "policy.json").read_text())
    legs = [f"{leg}_{kind}_joint" for leg in ("FL", "FR", "RL", "RR") for kind in ("hip", "thigh", "calf")]
    assert found["joint_names"] == legs
    assert found["default_pose"] == [0.0, 0.9, -1.8] * 4
    assert found["kp"] == [30.0, 30.0, 40.0] * 4 and found["kd"] == [1.0] * 12
    assert found["action_scale"] == 0.25 and found["control_period"] == 0.02
    assert found["skills"] == ["trot", "pace", "bound", "pronk"] and found["observe_skill"] is True
    assert found["command_range"] == {
        "vx_m_s": [-0.4, 0.9],
        "vy_m_s": [-0.25, 0.25],
        "yaw_rate_rad_s": [-0.6, 0.6],
    }
    assert found["camp_version"] == "0.1.0" and found["opset"] == 17
    assert found["observation"] == [
        {"name": "base_angular_velocity", "size": 3, "unit": "rad/s"},
        {"name": "gravity", "size": 3, "unit": "1"},
        {"name": "command", "size": 3, "unit": "m/s, m/s, rad/s"},
        {"name": "joint_position", "size": 12, "unit": "rad"},
        {"name": "joint_velocity", "size": 12, "unit": "rad/s"},
        {"name": "last_action", "size": 12, "unit": "1"},
        {"name": "skill", "size": 4, "unit": "1"},
    ]


def test_metadata_in_the_model_are_those_beside_it(exported):
    session = onnxruntime.InferenceSession(str(exported / "policy.onnx"), providers=["CPUExecutionProvider"])
    inside = {key: json.loads(value) for key, value in session.get_modelmeta().custom_metadata_map.items()}
    assert inside == json.loads((exported / "policy.json").read_text())


def test_metadata_follow_the_configuration():
    changes = ["motion.labels=gait_frequency", "motion.skills=[trot,bound]", "motion.frequencies_hz=[2,3]"]
    changes += ["run=scratch", "robot.kp=[20,25,35]", "robot.action_scale=0.5", "env.observe_skill=false"]
    found = metadata(compose_config(changes))
    assert found["skills"] == ["trot_2hz", "trot_3hz", "bound_2hz", "bound_3hz"]
    assert found["observation"][-1] == {"name": "skill", "size": 4, "unit": "1"} and found["observe_skill"] is False
    assert found["kp"] == [20.0, 25.0, 35.0] * 4 and found["action_scale"] == 0.5


def test_nothing_of_the_machine_is_in_the_file(run, exported):
    content = (exported / "policy.onnx").read_bytes()
    for path in (run, Path.home(), Path(torch.__file__).parent):
        assert str(path).encode() not in content


def test_another_kind_of_layer_is_refused(loaded):
    actor = copy.deepcopy(loaded.actor)
    actor.network[1] = torch.nn.Tanh()
    targets = JointTargets(GO2, actor, 0.25)
    with pytest.raises(ExportError, match="layer 1 is a Tanh: only Linear and ELU"):
        policy_graph(actor, targets.default_pose, 0.25, {})


def test_a_policy_that_answers_no_numbers_is_refused(run, loaded, tmp_path, monkeypatch):
    broken = copy.deepcopy(loaded)
    with torch.no_grad():
        broken.actor.network[0].weight.fill_(float("nan"))
    monkeypatch.setattr("camp.deployment.export.load_run", lambda folder: broken)
    with pytest.raises(ExportError, match="its joint targets are not finite; export a run whose training held"):
        export_policy(run, tmp_path / "never")
    assert not (tmp_path / "never").exists()


def test_a_missing_package_is_one_line_with_the_remedy(run, tmp_path, monkeypatch):
    monkeypatch.setattr(onnx_graph, "find_spec", lambda name: None if name == "onnxruntime" else True)
    with pytest.raises(ExportError, match=r"package onnxruntime: not installed; .*pip install -e '.\[export\]'"):
        export_policy(run, tmp_path / "never")
    assert not (tmp_path / "never").exists()


def test_command_writes_into_the_run_folder(run, capsys):
    export([f"run={run}"])
    assert (run / "policy.onnx").is_file() and (run / "policy.json").is_file()
    assert "largest difference to torch" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run=none"], "run folder none: holds no config.yaml"),
        (["rum=none"], "argument 'rum=none': did you mean run=? give run=<value> [output=<value>]"),
        (["run="], "argument 'run=': give run=<value>, once"),
        ([], "argument run=<value> is missing: give run=<value> [output=<value>]"),
    ],
)
def test_wrong_arguments_are_one_line(tmp_path, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(tmp_path)
    assert run_command(export, arguments, "usage") == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith(f"error: {message}") and captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_command_as_it_is_typed(run, tmp_path):
    command = [sys.executable, "-m", "camp.export", f"run={run}", "output=here"]
    done = subprocess.run(command, cwd=tmp_path, env=os.environ | {"OMP_NUM_THREADS": "1"}, capture_output=True)
    assert done.returncode == 0 and done.stderr == b""
    assert sorted(path.name for path in (tmp_path / "here").iterdir()) == ["policy.json", "policy.onnx"]


def test_unitrees_controllers_get_a_policy_for_each_skill(run, loaded, tmp_path, capsys):
    assert run_command(export, [f"run={run}", f"output={tmp_path}", "controller=unitree"], None) == 0
    assert capsys.readouterr().out.count("wrote ") == len(loaded.skills)
    observation = 3.0 * torch.randn(1, 45, generator=torch.Generator().manual_seed(5))
    for label, skill in enumerate(loaded.skills):
        folder = tmp_path / "unitree" / skill
        session = onnxruntime.InferenceSession(str(folder / "exported/policy.onnx"), providers=["CPUExecutionProvider"])
        assert [(one.name, one.shape) for one in session.get_inputs()] == [("obs", [1, 45])]  # what OrtRunner sizes
        (action,) = session.run(None, {"obs": observation.numpy()})
        one_hot = torch.eye(len(loaded.skills))[label : label + 1]
        with torch.no_grad():
            expected = loaded.actor(torch.cat([observation, one_hot], dim=1))
        torch.testing.assert_close(torch.from_numpy(action), expected, atol=1e-5, rtol=0.0)

        told = yaml.safe_load((folder / "params/deploy.yaml").read_text())
        # Unitree's own file for the Go2 has the same map: FL's joints are motors 3, 4, 5.
        assert told["joint_ids_map"] == [3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8]
        assert told["stiffness"][:3] == [30.0, 30.0, 40.0] and told["step_dt"] == 0.02
        position = told["actions"]["JointPositionAction"]
        assert (
            position["scale"] == [0.25] * 12 and position["offset"] == told["default_joint_pos"] == [0.0, 0.9, -1.8] * 4
        )
        assert sum(len(term["scale"]) for term in told["observations"].values()) == 45
        assert list(told["observations"])[:3] == ["base_ang_vel", "projected_gravity", "velocity_commands"]


def test_unitrees_controllers_show_a_policy_one_control_step(tmp_path, capsys):
    run = small_run(tmp_path, ["env.observation.history=2"])
    assert run_command(export, [f"run={run}", "controller=unitree"], None) == 2
    assert "env.observation.history = 2" in capsys.readouterr().err


def test_what_unitrees_controllers_do_not_observe_is_told(tmp_path, capsys):
    other = small_run(tmp_path / "run", ["env.observation.policy=[gravity,skill,command]"])
    assert run_command(export, [f"run={other}", "controller=unitree"], None) == 2
    assert "env.observation.policy = gravity, skill, command" in capsys.readouterr().err
    assert run_command(export, [f"run={other}", "controller=ros"], None) == 2
    assert "choose camp or unitree" in capsys.readouterr().err
