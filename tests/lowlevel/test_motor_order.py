"""The SDK's motors are this project's joints, each under its own name."""

from __future__ import annotations

import numpy as np

from camp.lowlevel.motor_order import MOTOR_NAMES, from_motors, to_motors
from camp.robots.quadruped import JOINT_NAMES

# unitree_legged_const.py of Unitree's SDK: FR_0 = 0, FL_0 = 3, RR_0 = 6, RL_0 = 9; hip, thigh, calf.
UNITREE = {"FR": 0, "FL": 3, "RR": 6, "RL": 9}


def test_every_joint_goes_to_its_motor():
    values = np.arange(12, dtype=np.float32)
    motors = to_motors(values)
    for joint, name in enumerate(JOINT_NAMES):
        leg, kind, _ = name.split("_")
        motor = UNITREE[leg] + ("hip", "thigh", "calf").index(kind)
        assert motors[motor] == values[joint] and MOTOR_NAMES[motor] == name


def test_there_and_back_is_nothing():
    values = np.arange(12, dtype=np.float32)
    np.testing.assert_array_equal(from_motors(to_motors(values)), values)
    assert to_motors(values).tolist() == [3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8]
