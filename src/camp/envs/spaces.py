"""The bounds of the single environment's spaces."""

from __future__ import annotations

import numpy as np
from gymnasium.spaces import Box

from camp.robots.robot import Robot


def useful_actions(robot: Robot, action_scale: float) -> Box:
    """The network outputs (12,) that differ in what they do; action_scale: rad per unit.

    Beyond them the motor of a joint within its range and speed gives its full torque whatever the target. Finite
    bounds are what other projects' algorithms ask for; nothing is clipped here.
    """
    lower, upper, pose = map(np.array, (robot.joint_lower, robot.joint_upper, robot.default_joint_position))
    gain, damping = np.array(robot.pd_gain_p), np.array(robot.pd_gain_d)
    reach = (np.array(robot.torque_limit) + damping * np.array(robot.joint_speed_limit)) / gain
    low, high = ((target - pose) / action_scale for target in (lower - reach, upper + reach))
    return Box(low.astype(np.float32), high.astype(np.float32))
