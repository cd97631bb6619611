"""The commands of the robot's low-level interface explain what they cannot use, before anything moves."""

from __future__ import annotations

import pytest

from camp import go2, go2_sim
from tests.errors import assert_one_line

pytest.importorskip("onnxruntime", reason="comes with the export extra")


def test_a_missing_policy_is_named(capsys):
    assert go2.main(["nowhere.onnx", "--interface", "lo"]) == 2
    assert_one_line(capsys.readouterr().err, "policy nowhere.onnx: not found")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--interface"),
        (["--interface", "nic7"], "--interface 'nic7': no such network interface; choose one of"),
        (["--interface", "lo", "--domain", "300"], "--domain 300: choose 0 to 232"),
        (["--interface", "lo", "--command-loss", "2"], "loss 2"),
        (["--interface", "lo", "--state-delay", "-1"], "delay -1"),
        (["--interface", "lo", "--seconds", "0"], "--seconds 0"),
        (["--interface", "lo", "--watchdog", "x"], "--watchdog"),
    ],
)
def test_wrong_options_of_the_simulated_robot_are_one_line(capsys, arguments, message):
    pytest.importorskip("cyclonedds", reason="comes with the go2 extra")
    pytest.importorskip("unitree_sdk2py", reason="comes with the go2 extra")
    assert go2_sim.main(arguments) == 2
    assert_one_line(capsys.readouterr().err, message)


def test_the_loopback_has_the_simulators_domain_and_a_cable_the_robots():
    for arguments, domain in ((["lo"], 1), (["eth0"], 0), (["eth0", "--domain", "7"], 7)):
        assert go2.domain_of(go2._parser().parse_args(["--interface", *arguments])) == domain


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--script", "0 fly"], "--script '0 fly'"),
        (["--skill", "gallop"], "skill 'gallop': unknown to this policy"),
        (["--interface", "nic7"], "--interface 'nic7'"),
    ],
)
def test_wrong_options_of_the_controller_are_one_line(capsys, shipped_path, arguments, message):
    pytest.importorskip("cyclonedds", reason="comes with the go2 extra")
    pytest.importorskip("unitree_sdk2py", reason="comes with the go2 extra")
    assert go2.main([str(shipped_path), "--interface", "lo", *arguments]) == 2
    assert_one_line(capsys.readouterr().err, message)
