"""The expert behind the learner's interface: it answers a state with joint targets for the learner's PD.

The torque controller is rolled forward by one control step on a copy of the robot; the PD targets that would
have given its torques are averaged over the step. Whoever executes the answer, the next one starts from the
true state.
"""

from __future__ import annotations

import mujoco
import numpy as np

from camp.gaits.schedule import GaitSchedule
from camp.motion.expert.controller import GaitController
from camp.motion.expert.heading import approach_command
from camp.robots.robot import Robot

CONTROL_PERIOD = 0.02  # s, the learner's control step
LARGEST_ACCELERATION = np.array([1.0, 1.0, 1.5])  # m/s^2, m/s^2, rad/s^2: how fast the command may be taken up


class Expert:
    """Walks one gait; `command` (3,) is the twist taken up so far, on its way to what was asked for."""

    def __init__(
        self,
        robot: Robot,
        data: mujoco.MjData,
        schedule: GaitSchedule,
        stand_duration: float,
        height: float = 0.0,
    ) -> None:
        """`data`: the learner's robot, standing at the origin; stand_duration in s; height: see GaitController."""
        self._model = robot.load_torque_model(data.model.opt.timestep)
        self._copy = mujoco.MjData(self._model)
        self._steps = round(CONTROL_PERIOD / self._model.opt.timestep)
        self._gain_p, self._gain_d = np.array(robot.pd_gain_p), np.array(robot.pd_gain_d)
        self.command = np.zeros(3)
        self._synchronize(data)
        self.controller = GaitController(robot, self._copy, schedule, stand_duration, height)

    @property
    def time(self) -> float:
        """Time since the gait began in s, negative while standing."""
        return self.controller.target.time

    @property
    def begins_stride(self) -> bool:
        """Whether a stride began within the last control step."""
        frequency = self.controller.schedule.frequency_hz
        now, before = self.time, self.time - CONTROL_PERIOD
        return bool(np.floor(now * frequency + 1e-6) > np.floor(before * frequency + 1e-6))

    def change_gait(self, data: mujoco.MjData, schedule: GaitSchedule, stand_duration: float) -> None:
        """Walk another gait from now on, after `stand_duration` s on all four feet."""
        self._synchronize(data)
        self.controller = self.controller.succeed(self._copy, schedule, stand_duration)

    @property
    def predicted_joint_position(self) -> np.ndarray:
        """Where the joints (12,) would be at the end of the latest answer's control step, in rad."""
        return self._copy.qpos[7:].copy()

    def answer(self, data: mujoco.MjData, command: np.ndarray) -> np.ndarray:
        """Joint targets (12,) in rad to hold for the coming control step, towards the twist `command` (3,).

        Raises ValueError where the controller finds no solution: the robot has fallen or will.
        """
        if self.time >= 0.0:
            self.command = approach_command(self.command, command, LARGEST_ACCELERATION * CONTROL_PERIOD)
        self._synchronize(data)
        self.controller.plan(self._copy, self.command)
        total = np.zeros(len(self._gain_p))
        for _ in range(self._steps):
            mujoco.mj_step1(self._model, self._copy)
            position = self._copy.qpos[7:].copy()
            torque = self.controller.torque(self._copy, self._model.opt.timestep)
            self._copy.ctrl[:] = torque
            mujoco.mj_step2(self._model, self._copy)
            # The integrator takes damping at the end of the step (implicitfast), hence the velocity after it.
            total += position + (torque + self._gain_d * self._copy.qvel[6:]) / self._gain_p
        return total / self._steps

    def _synchronize(self, data: mujoco.MjData) -> None:
        self._copy.qpos[:], self._copy.qvel[:] = data.qpos, data.qvel
        self._copy.qacc_warmstart[:] = data.qacc_warmstart
        mujoco.mj_forward(self._model, self._copy)
