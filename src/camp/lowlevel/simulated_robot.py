"""A Go2 in MuJoCo whose motors obey commands as the real drives do."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from camp.common.errors import SimulationError
from camp.lowlevel.messages import Command, Reading
from camp.lowlevel.motion import FOLDED
from camp.robots.mujoco_robot import Joints, has_diverged, put_on_ground
from camp.robots.quadruped import CONTACT_FORCE, FOOT_NAMES, GRAVITY, JOINT_NAMES
from camp.robots.robot import Robot

UP = np.array([0.0, 0.0, GRAVITY])  # m/s^2, what a resting accelerometer feels


class SimulatedRobot:
    """One robot on flat ground, lying on folded legs at first. Joint values are in the order of JOINT_NAMES."""

    def __init__(self, robot: Robot):
        self._model = mujoco.MjModel.from_xml_path(str(robot.model_path))
        self.data = mujoco.MjData(self._model)
        self._joints = Joints.of(self._model, JOINT_NAMES)
        self.timestep_s = float(self._model.opt.timestep)
        self.data.qpos[self._joints.position] = FOLDED
        put_on_ground(self._model, self.data)

    def step(self, command: Command | None) -> None:
        """One timestep under a command; None: the motors are off. Raises SimulationError where it diverges."""
        motor, gain, bias = self._joints.motor, self._model.actuator_gainprm, self._model.actuator_biasprm
        gain[motor, 0] = 1.0
        if command is None:
            bias[motor, 1:3] = 0.0
            self.data.ctrl[motor] = 0.0
        else:
            bias[motor, 1], bias[motor, 2] = -command.kp, -command.kd
            drive = command.torque + command.kp * command.target + command.kd * command.velocity
            self.data.ctrl[motor] = drive
        mujoco.mj_step(self._model, self.data)
        if has_diverged(self.data):
            raise SimulationError("the simulated robot's state is not finite: the simulation diverged; check the gains")

    def reading(self, remote: bytes) -> Reading:
        """What its sensors tell now. remote: the state of the wireless remote."""
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, self.data.qpos[3:7])
        felt = turn.reshape(3, 3).T @ (self.data.qacc[:3] + UP)
        return Reading(
            time_ms=round(self.data.time * 1000),
            joint_position=self.data.qpos[self._joints.position].astype(np.float32),
            joint_velocity=self.data.qvel[self._joints.velocity].astype(np.float32),
            attitude=self.data.qpos[3:7].astype(np.float32),
            angular_velocity=self.data.qvel[3:6].astype(np.float32),
            joint_torque=self.data.actuator_force[self._joints.motor].astype(np.float32),
            acceleration=felt.astype(np.float32),
            remote=remote,
        )

    @property
    def height(self) -> float:
        """Of the base's origin above the ground, m."""
        return float(self.data.qpos[2])

    @property
    def tilt(self) -> float:
        """Angle between the trunk's and the world's vertical, rad."""
        _, x, y, _ = self.data.qpos[3:7]
        return math.acos(float(np.clip(1 - 2 * (x * x + y * y), -1.0, 1.0)))

    @property
    def contact(self) -> NDArray[np.bool_]:
        """(4,) feet in the order of FOOT_NAMES that press on the ground."""
        forces = [np.linalg.norm(self.data.sensor(f"{foot}_contact").data) for foot in FOOT_NAMES]
        return np.array(forces) > CONTACT_FORCE
