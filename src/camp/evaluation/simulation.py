"""The learner's simulation, watched at every physics step, and with targets that arrive late or never."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from camp.evaluation.robot import ROBOT
from camp.robots.quadruped import CONTACT_FORCE, NUM_JOINTS, NUM_LEGS
from camp.robots.robot import Robot
from camp.sim.base import InitialState
from camp.sim.cpu import CpuSimulator

_FEET = 3 * NUM_LEGS  # values of the feet's force sensors, which come first


class WatchedSimulator(CpuSimulator):
    """`CpuSimulator` that tells the feet's contacts of every physics step and delays each robot's joint targets.

    Contacts at the control rate alone miss what lasts a few milliseconds: the flight of a bound, and that a break in a
    stance is one physics step long.

    Args:
        robot: with the nominal PD gains.
        control_period: s, of ``step``.
        physics_timestep: s.
        threads: simulation threads, 0 for one per processor.
        delay_steps: (N,) physics steps by which a robot's targets arrive late.
    """

    def __init__(
        self,
        robot: Robot,
        control_period: float,
        physics_timestep: float,
        threads: int,
        delay_steps: NDArray[np.integer],
    ):
        super().__init__(robot, len(delay_steps), control_period, physics_timestep, threads)
        self.substeps = round(control_period / physics_timestep)
        self._delay = np.asarray(delay_steps)
        self._sent: list[np.ndarray] = []  # targets (N, 12) of the latest control steps, newest last
        self.contact = np.zeros((self.num_envs, self.substeps, NUM_LEGS), dtype=bool)  # of the latest control step

    def hold_before(self, joint_target: Tensor) -> None:
        """What the robots' motors held until now, (N, 12) rad: delayed robots go on with it."""
        kept = 1 + -(-int(self._delay.max(initial=0)) // self.substeps)
        self._sent = [joint_target.numpy(force=True).astype(np.float64)] * kept

    def step(self, joint_target: Tensor) -> None:
        self._sent = [*self._sent[1:], joint_target.numpy(force=True).astype(np.float64)]
        for step in range(self.substeps):
            # Of a target that is d physics steps old, the one sent so many control steps ago is what arrives now.
            age = np.ceil(np.maximum(self._delay - step, 0) / self.substeps).astype(int)
            ctrl = self._rows["ctrl"]
            for steps_ago in np.unique(age):
                robots = age == steps_ago
                ctrl[robots] = self._sent[-1 - steps_ago][robots]
            self._batch.step(nstep=1)
            force = self._sensordata[:, :_FEET].reshape(-1, NUM_LEGS, 3)
            self.contact[:, step] = np.linalg.norm(force, axis=2) > CONTACT_FORCE
        self._forces[:] = self._sensordata

    def reset(self, mask: Tensor, initial: InitialState) -> None:
        super().reset(mask, initial)
        robots = mask.numpy()
        for sent in self._sent:
            sent[robots] = initial.joint_position.numpy()[robots]


def on_floor(num: int) -> InitialState:
    """``num`` robots that stand still in the default pose."""
    model = ROBOT.load_model()
    stand = torch.tensor(model.key("stand").qpos, dtype=torch.float32).expand(num, -1)
    return InitialState(
        base_position=stand[:, :3],
        base_quaternion=stand[:, 3:7],
        base_linear_velocity=torch.zeros(num, 3),
        base_angular_velocity=torch.zeros(num, 3),
        joint_position=stand[:, 7:],
        joint_velocity=torch.zeros(num, NUM_JOINTS),
    )
