"""Where robots that fell lie for the rest of a roll-out."""

from __future__ import annotations

import torch

from camp.robots.quadruped import NUM_JOINTS
from camp.robots.robot import Robot
from camp.sim.base import InitialState


def on_floor(robot: Robot, num: int) -> InitialState:
    """``num`` robots that stand still in the default pose."""
    model = robot.load_model()
    stand = torch.tensor(model.key("stand").qpos, dtype=torch.float32).expand(num, -1)
    return InitialState(
        base_position=stand[:, :3],
        base_quaternion=stand[:, 3:7],
        base_linear_velocity=torch.zeros(num, 3),
        base_angular_velocity=torch.zeros(num, 3),
        joint_position=stand[:, 7:],
        joint_velocity=torch.zeros(num, NUM_JOINTS),
    )
