"""Unitree's SDK numbers its motors FR, FL, RR, RL; everything else here is in the order of JOINT_NAMES."""

from __future__ import annotations

import numpy as np

from camp.lowlevel.messages import Array
from camp.robots.motor_order import MOTOR_NAMES
from camp.robots.quadruped import JOINT_NAMES

_JOINT_OF_MOTOR = np.array([JOINT_NAMES.index(name) for name in MOTOR_NAMES])
_MOTOR_OF_JOINT = np.argsort(_JOINT_OF_MOTOR)


def to_motors(values: Array) -> Array:
    """(12,) in the order of JOINT_NAMES -> (12,) in the order of the motors."""
    return values[_JOINT_OF_MOTOR]


def from_motors(values: Array) -> Array:
    """(12,) in the order of the motors -> (12,) in the order of JOINT_NAMES."""
    return values[_MOTOR_OF_JOINT]
