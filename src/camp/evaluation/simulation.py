"""The learner's simulation, watched at every physics step."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from camp.robots.quadruped import CONTACT_FORCE, NUM_JOINTS, NUM_LEGS
from camp.robots.robot import Robot
from camp.sim.base import InitialState
from camp.sim.cpu import CpuSimulator

_FEET = 3 * NUM_LEGS  # values of the feet's force sensors, which come first


class WatchedSimulator(CpuSimulator):
    """`CpuSimulator` that tells the feet's contacts of every physics step.

    Contacts at the control rate alone miss what lasts a few milliseconds: the flight of a bound, and that a break in a
    stance is one physics step long.

    Args:
        As of `CpuSimulator`.
    """

    def __init__(self, robot: Robot, num_envs: int, control_period: float, physics_timestep: float, threads: int):
        super().__init__(robot, num_envs, control_period, physics_timestep, threads)
        self.contact = np.zeros((self.num_envs, self.substeps, NUM_LEGS), dtype=bool)  # of the latest control step

    def hold_before(self, joint_target: Tensor) -> None:
        """What the robots' motors held until now, (N, 12) rad: delayed robots go on with it."""
        self._delays.hold(joint_target)

    def step(self, joint_target: Tensor) -> None:
        self._delays.send(joint_target)
        for step in range(self.substeps):
            self._rows["ctrl"][:] = self._delays.arrived(step).numpy()
            self._batch.step(nstep=1)
            force = self._sensordata[:, :_FEET].reshape(-1, NUM_LEGS, 3)
            self.contact[:, step] = np.linalg.norm(force, axis=2) > CONTACT_FORCE
        self._forces[:] = self._sensordata


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
