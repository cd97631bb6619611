"""MuJoCo, the learner's own engine: what the others are compared with."""

from __future__ import annotations

import mujoco
import numpy as np

from camp.robots.mujoco_robot import Joints
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from camp.robots.registry import find_robot
from camp.transfer.description import Description
from camp.transfer.engine import READING_S, Contacts, Floats, State, contacts_of


def start(description: Description) -> MujocoEngine:
    """The robot on the ground."""
    return MujocoEngine(description)


class MujocoEngine:
    """The robot's own model: 5-ms steps, implicit damping, soft contacts."""

    def __init__(self, description: Description):
        self._description = description
        self._model = mujoco.MjModel.from_xml_path(str(find_robot(description.name).model_path))
        self._data = mujoco.MjData(self._model)
        self._joints = Joints.of(self._model, JOINT_NAMES)
        self._joints.set_gains(self._model, description.kp, description.kd)
        self.timestep_s = float(self._model.opt.timestep)
        # By the names that `contacts_of` reads; each sensor is the ground's net force on a part.
        self._sensor = {f"{foot}_foot": f"{foot}_contact" for foot in FOOT_NAMES}
        self._sensor |= {link: f"{link}_contact" for link in description.trunk_and_thighs}

    def reset(self) -> None:
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[2] = self._description.height
        self._data.qpos[self._joints.position] = self._description.default_pose
        self.set_targets(self._description.default_pose)
        mujoco.mj_forward(self._model, self._data)

    def set_targets(self, target: Floats) -> None:
        self._data.ctrl[self._joints.motor] = target

    def step(self) -> None:
        mujoco.mj_step(self._model, self._data, round(READING_S / self.timestep_s))

    def state(self) -> State:
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, self._data.qpos[3:7])
        rotation = turn.reshape(3, 3)
        return State(
            position=self._data.qpos[:3].copy(),
            rotation=rotation,
            angular_velocity=rotation @ self._data.qvel[3:6],
            joint_position=self._data.qpos[self._joints.position],
            joint_velocity=self._data.qvel[self._joints.velocity],
        )

    def contacts(self) -> Contacts:
        force = {part: self._data.sensor(name).data for part, name in self._sensor.items()}
        return contacts_of(force, self._description)
