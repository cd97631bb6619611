"""Unitree's messages carry every number to its motor and back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="comes with the go2 extra")
pytest.importorskip("unitree_sdk2py", reason="comes with the go2 extra")

from camp.lowlevel.messages import Command
from camp.lowlevel.wire import CommandReader, CommandWriter, StateWriter, reading_of
from tests.lowlevel.rig import joints, reading

NUMBERS = np.arange(12, dtype=np.float32) / 8  # exact as 32-bit floats
COMMAND = Command(NUMBERS, NUMBERS + 20, NUMBERS + 1, NUMBERS - 1, NUMBERS - 2, step=7)


def test_a_command_is_understood_by_the_other_side():
    message = CommandWriter().message(COMMAND)
    found = CommandReader().command(message)
    assert found is not None and found.step == 7
    for key in ("target", "kp", "kd", "velocity", "torque"):
        np.testing.assert_array_equal(getattr(found, key), getattr(COMMAND, key))


def test_a_command_is_as_unitrees_examples_fill_it():
    message = CommandWriter().message(COMMAND)
    assert (list(message.head), message.level_flag) == ([0xFE, 0xEF], 0xFF)
    fr_hip, fl_calf, unused = message.motor_cmd[0], message.motor_cmd[5], message.motor_cmd[12]
    assert (fr_hip.q, fr_hip.mode) == (NUMBERS[3], 1)
    assert (fl_calf.q, fl_calf.kp) == (NUMBERS[2], NUMBERS[2] + 20)
    assert (unused.q, unused.dq, unused.kp) == (2.146e9, 16000.0, 0.0)


def test_a_command_with_a_wrong_checksum_is_ignored():
    message = CommandWriter().message(COMMAND)
    message.motor_cmd[3].q += 0.5
    assert CommandReader().command(message) is None


def test_a_state_is_understood_by_the_other_side():
    sent = replace(
        reading(time_ms=123, tilt=0.25, position=NUMBERS),
        joint_velocity=NUMBERS - 1,
        joint_torque=NUMBERS + 2,
        angular_velocity=np.array([0.5, -0.25, 1.0], np.float32),
        acceleration=np.array([0.0, 0.5, 9.75], np.float32),
        remote=bytes(range(40)),
        step=9,
    )
    message = StateWriter().message(sent)
    assert message.motor_state[0].q == NUMBERS[3]  # FR hip
    found = reading_of(message)
    assert found is not None and (found.time_ms, found.step, found.remote) == (123, 9, bytes(range(40)))
    for key in ("joint_position", "joint_velocity", "joint_torque", "attitude", "angular_velocity", "acceleration"):
        np.testing.assert_array_equal(getattr(found, key), getattr(sent, key))


def test_a_state_that_is_no_number_is_none():
    assert reading_of(StateWriter().message(replace(reading(), joint_velocity=joints(np.nan)))) is None
