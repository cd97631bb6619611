"""The command line: walks, files and table, and input that cannot be used."""

from __future__ import annotations

import pytest

from camp.cli.key_values import run_command
from camp.common.paths import policies_root
from camp.deployment.export import export_policy
from camp.evaluation.suite import file_digest
from camp.transfer.__main__ import __doc__ as usage
from camp.transfer.__main__ import transfer
from camp.transfer.results import read_results, write_result
from tests.errors import assert_one_line
from tests.transfer.descriptions import A1
from tests.transfer.results import RIGHT, result

pytest.importorskip("onnx", reason="comes with the export extra")
pytest.importorskip("onnxruntime", reason="comes with the export extra")

SHIPPED = policies_root() / "go2_camp"


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return export_policy(SHIPPED, tmp_path_factory.mktemp("mine")).model


def test_walks_become_a_file_and_a_table(model, tmp_path, capsys):
    assert run_command(transfer, [str(model), "engine=mujoco", "skills=trot_3hz", f"output={tmp_path}"], usage) == 0
    (found,) = read_results(tmp_path)
    assert found.engine == "mujoco" and found.robot == "go2" and found.suite.seed == 0
    assert len(found.walks) == 5 and all(walk.gait == "trot" for walk in found.walks)
    (path,) = tmp_path.glob("*.json")
    assert path.name == f"go2_{model.parent.name}_mujoco.json"
    printed = capsys.readouterr().out
    assert "mujoco: 5 walks of 6 s" in printed and "engines, suite " in printed


def test_a_policy_walks_another_robot(model, tmp_path, capsys):
    arguments = [str(model), "engine=mujoco", "skills=trot_3hz", "robot=a1", f"output={tmp_path}"]
    assert run_command(transfer, arguments, usage) == 0
    (found,) = read_results(tmp_path)
    assert found.robot == found.suite.robot == "a1" and found.suite.model == file_digest(A1.model_path)
    assert (tmp_path / f"a1_{model.parent.name}_mujoco.json").is_file()
    assert " a1 " in capsys.readouterr().out


def test_the_table_is_printed_anew(tmp_path, capsys):
    write_result(tmp_path / "a.json", result("dart", RIGHT))
    write_result(tmp_path / "b.json", result("drake", RIGHT))
    assert run_command(transfer, ["table", f"output={tmp_path}"], usage) == 0
    printed = capsys.readouterr().out
    assert "dart" in printed and "drake" in printed and "1/1" in printed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give one policy.onnx or run folder, and engine=<name>; or table; see --help"),
        (["a.onnx", "b.onnx", "engine=dart"], "give one policy.onnx or run folder"),
        (["{model}"], "argument engine=<value> is missing"),
        (["{model}", "engine=gazebo"], "engine = 'gazebo': unknown engine; choose one of mujoco, sapien, dart, drake"),
        (["{model}", "motor=dart"], "argument 'motor=dart': give engine=<value>"),
        (["none.onnx", "engine=mujoco"], "policy none.onnx: not found"),
        (["{model}", "engine=mujoco", "skills=walk"], "skill 'walk': unknown to this policy; choose one of trot_2hz"),
        (["{model}", "engine=mujoco", "suite=long"], "suite"),
        (["{model}", "engine=mujoco", "robot=spot"], "robot = 'spot': unknown robot; choose one of go2, a1"),
        (["table", "output={empty}"], "holds no results"),
        (["table", "engine=dart"], "argument 'engine=dart': give [output=<value>]"),
    ],
)
def test_input_that_cannot_be_used_is_one_line(model, tmp_path, capfd, arguments, message):
    given = [argument.format(model=model, empty=tmp_path) for argument in arguments]
    assert run_command(transfer, given, usage) == 2
    assert_one_line(capfd.readouterr().err, message)


def test_help_is_the_modules_text(capsys):
    assert run_command(transfer, ["--help"], usage) == 0
    assert "engine=<name>" in capsys.readouterr().out
