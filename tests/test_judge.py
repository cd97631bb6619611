"""Judging what others made: contact logs by a script that knows nothing of camp, and foreign ONNX policies."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from camp import judge as command
from camp.cli.key_values import run_command
from camp.common.errors import CampError
from camp.common.paths import policies_root
from camp.deployment.export import export_policy
from camp.evaluation import labelled
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.contact_log import read_log
from camp.evaluation.contact_report import judge_log
from camp.evaluation.contract import Term, read_contract
from camp.evaluation.controllers import robot_of
from camp.evaluation.expert import judge_expert
from camp.evaluation.policies import OnnxAnswer
from camp.evaluation.report import read_report
from camp.robots.a1 import A1
from camp.robots.go2 import GO2
from tests.errors import assert_one_line
from tests.small_run import small_run

onnx = pytest.importorskip("onnx", reason="comes with the export extra")
pytest.importorskip("onnxruntime", reason="comes with the export extra")

# A robot of 4 s of trot at 2 Hz and 4 s of pronk at 2.5 Hz, written with the standard library alone.
INDEPENDENT = """
import csv, sys
rows, rate = [["time", "FL", "FR", "RL", "RR", "skill"]], 100
for i in range(8 * rate):
    t = i / rate
    if t < 4:
        down = [((t * 2 + phase) % 1) < .5 for phase in (0, .5, .5, 0)]
    else:
        down = [((t * 2.5) % 1) < .55] * 4
    rows.append([t, *(SCALE * d for d in down), "trot" if t < 4 else "pronk"])
csv.writer(open(sys.argv[1], "w")).writerows(rows)
"""


def independent(path: Path, scale: str = "1") -> Path:
    subprocess.run([sys.executable, "-c", INDEPENDENT.replace("SCALE", scale), str(path)], check=True)
    return path


def test_a_log_from_elsewhere_is_read_and_judged(tmp_path, capsys):
    log = independent(tmp_path / "log.csv")
    assert run_command(command.judge, [f"contacts={log}", f"output={tmp_path}"], "") == 0
    found = json.loads((tmp_path / "log.json").read_text())
    trot, *_, pronk = [part for part in found["stretches"] if part["duty"]]
    assert (trot["gait"], pronk["gait"]) == ("trot", "pronk")
    assert trot["frequency_hz"] == pytest.approx(2.0, abs=0.02) and pronk["frequency_hz"] == pytest.approx(
        2.5, abs=0.03
    )
    assert trot["duty"] == pytest.approx([0.5] * 4, abs=0.02) and pronk["flight_fraction"] == pytest.approx(
        0.45, abs=0.02
    )
    assert trot["failed"] == [] and pronk["failed"] == [] and trot["lifts"] is None
    assert trot["phase"] == pytest.approx([0, 0.5, 0.5, 0], abs=0.02)
    (switch,) = found["switches"]
    assert switch["at_s"] == pytest.approx(4.0, abs=0.02) and switch["skill"] == "pronk" and switch["seconds"] <= 0.6
    assert "trot" in capsys.readouterr().out


def test_the_whole_log_against_a_skill(tmp_path):
    log = read_log(independent(tmp_path / "log.csv"))
    assert judge_log(log, "log", "trot_2hz").failed[0] == "gait"
    later = judge_log(log, "log", "pronk_2.5hz", discard_s=4.0)
    assert later.failed == [] and later.stretches[0].start_s == 4.0
    with pytest.raises(CampError, match="leave 2 s or more"):
        judge_log(log, "log", discard_s=7.0)
    with pytest.raises(CampError, match="skill 'walk' is none of the judge's"):
        judge_log(log, "log", "walk")


def test_forces_need_a_threshold(tmp_path):
    log = independent(tmp_path / "log.csv", "80.5")
    with pytest.raises(CampError, match="other values than 0 and 1; give threshold_n=<N> if they are forces"):
        read_log(log)
    np.testing.assert_array_equal(read_log(log, 20.0).contact, read_log(independent(tmp_path / "other.csv")).contact)


def test_an_uneven_log_is_resampled(tmp_path):
    time = np.cumsum(np.random.default_rng(0).uniform(0.005, 0.015, 800))
    contact = np.mod(time[:, None] * 2 - [0, 0.5, 0.5, 0], 1) < 0.5
    height = np.where(contact, 0.0, 0.05)
    np.savez(tmp_path / "log.npz", time=time, contact=contact, height=height)
    log = read_log(tmp_path / "log.npz")
    assert log.seconds == pytest.approx(time[-1] - time[0], abs=0.02)
    assert judge_log(log, "log", "trot_2hz").failed == []
    np.savez(tmp_path / "flat.npz", time=time, contact=contact, height=0.1 * height)
    assert judge_log(read_log(tmp_path / "flat.npz"), "flat", "trot_2hz").failed == ["lift"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time,FL,FR,RL\n0,1,1,1\n", "column 'RR' is missing; give time, FL, FR, RL, RR"),
        ("time,FL,FR,RL,RR\n0,1,1,1,1\n0,1,1,1,1\n1,1,1,1,1\n", "its times do not rise"),
        ("time,FL,FR,RL,RR\n0,1,1,1,1\n0.1,1,1,1,1\n0.2,1,1,1,1\n", "a row every 0.100 s; sample at 50 Hz or more"),
        ("time,FL,FR,RL,RR\n0,1,1,1\n", "line 2 has 4 columns, the heading 5"),
        ("time,FL,FR,RL,RR\n0,1,1,1,up\n", "column 'RR' holds what is no number"),
        ("time,FL,FR,RL,RR\n0,1,1,1,nan\n", "holds values that are not finite"),
        (None, "cannot be read"),
    ],
)
def test_a_log_that_cannot_be_used_is_one_line(text, message, tmp_path, capsys):
    path = tmp_path / "log.csv"
    if text is not None:
        path.write_text(text)
    assert run_command(command.judge, [f"contacts={path}"], "") == 2
    assert_one_line(capsys.readouterr().err, message)


@pytest.fixture(scope="module")
def open_loop(tmp_path_factory) -> Path:
    from analysis.open_loop import write

    folder = tmp_path_factory.mktemp("open_loop")
    write([str(folder)])
    return folder


def test_a_hand_written_generator_is_judged_behind_its_contract(open_loop, tmp_path, monkeypatch, capsys):
    values = ["duration_s=4.5", "walks.per_skill=1", "walks.baseline_per_skill=1", "parts=[gait,tracking]", "threads=1"]
    monkeypatch.setattr(command, "compose_evaluation", lambda _: compose_evaluation(["suite=short", *values]))
    arguments = [f"policy={open_loop / 'open_loop.onnx'}", f"contract={open_loop / 'open_loop.json'}"]
    assert run_command(command.judge, [*arguments, f"output={tmp_path}"], "") == 0
    found = read_report(tmp_path / "open_loop.json", "")
    assert found.run == "open_loop" and len(found.skills) == 8 and found.suite.name == "custom"
    assert found.policies["trained"].all.rollouts == 8 and found.seed is None
    assert "gaits, nominal" in capsys.readouterr().out


def test_a_policy_is_judged_on_another_robot_beside_that_ones_clips(open_loop, monkeypatch):
    asked = []
    monkeypatch.setattr(command, "expert_motions", lambda robot: asked.append(robot) or [])
    network = {"policy": str(open_loop / "open_loop.onnx"), "contract": str(open_loop / "open_loop.json")}
    subject, _ = command._subject("policy", network, False)
    assert asked.pop() is GO2 and (subject.name, subject.contract.robot) == ("open_loop", "go2")
    for kind, given in (("policy", network), ("run", {"run": str(policies_root() / "go2_camp")})):
        own, _ = command._subject(kind, given, False)
        other, _ = command._subject(kind, given | {"robot": "a1"}, False)
        assert asked.pop() is A1 and other.name == f"{own.name}_on_a1" and robot_of(other.contract).leg == A1.leg
        assert other.contract.default_pose == own.contract.default_pose and other.policy == own.policy


def test_what_camp_exports_needs_no_contract(tmp_path):
    run = small_run(tmp_path / "run", ["motion.skills=[trot]"])
    answer = OnnxAnswer(export_policy(run, run).model)
    contract = command.contract_inside(answer)
    answer.check(contract)
    assert list(contract.skills) == ["trot"] and contract.output.scale == 1.0
    assert contract.observation[-2] == Term("last_action", scale=4.0, offset=contract.default_pose)


def test_a_policy_that_does_not_fit_is_one_line(open_loop, tmp_path, capsys):
    policy, contract = open_loop / "open_loop.onnx", open_loop / "open_loop.json"
    wrong = json.loads(contract.read_text())
    wrong["observation"].append({"term": "gravity"})
    (tmp_path / "wrong.json").write_text(json.dumps(wrong))
    for arguments, message in (
        ([f"policy={policy}"], "holds no metadata of camp.export; give contract=<file>"),
        (
            [f"policy={policy}", f"contract={tmp_path / 'wrong.json'}"],
            "takes 14 numbers, its contract's observation has 17",
        ),
        ([f"policy={contract}", f"contract={contract}"], "not a readable ONNX file"),
        ([f"policy={tmp_path / 'none.onnx'}"], "not found"),
        ([], "nothing to judge: give policy="),
        ([f"policy={policy}", "contrakt=a"], "did you mean contract=?"),
        (["contacts=a.csv", "threshold_n=much"], "threshold_n = 'much': give a number"),
        (
            [f"policy={policy}", f"contract={contract}", "robot=spot"],
            "robot = 'spot': unknown robot; choose one of go2",
        ),
        (["expert", "robot=spot"], "robot = 'spot': unknown robot; choose one of go2"),
    ):
        assert run_command(command.judge, [*arguments], "") == 2
        assert_one_line(capsys.readouterr().err, message)


def test_the_contract_of_the_generator_is_what_the_page_shows(open_loop):
    assert read_contract(open_loop / "open_loop.json").observation_size == 14


def test_the_judge_is_right_about_motions_whose_answer_is_known(monkeypatch):
    """`python -m camp.judge labelled`, with its simulated part cut short."""
    monkeypatch.setattr(labelled, "AMPLITUDES_RAD", (0.15,))
    answers = list(labelled.labelled_answers())
    assert len(answers) == 305 + 11 + 32
    assert sum(answer.correct for answer in answers) >= 0.99 * len(answers)
    assert not [answer.name for answer in answers if answer.adversarial and not answer.correct]


def test_the_experts_clips_are_right():
    found = judge_expert(GO2)
    assert found.policies["trained"].all.gait_accuracy.value == 1.0
    assert found.reference["all"].policy["thigh"].accuracy > 0.97
    assert found.suite.name == "clips"
