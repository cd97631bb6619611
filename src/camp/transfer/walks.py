"""A policy's walks in any engine: the loop of `camp.deployment.loop`, and what the judge reads of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from camp.common.errors import CampError
from camp.deployment.loop import Array, Policy, control
from camp.deployment.simulated import FALL_TILT
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from camp.robots.robot import Robot
from camp.transfer.description import fused_model
from camp.transfer.engine import READING_S, Engine, Floats


@dataclass
class Walk:
    """What a robot did over T control steps, fewer where it fell; C readings of the contacts in each."""

    contact: NDArray[np.bool_]  # (T C, 4) FL, FR, RL, RR
    foot_height: Floats  # (T, 4) m, lowest point of each foot above the ground, at the step's end
    velocity: Floats  # (T, 3) mean vx, vy in m/s and yaw rate in rad/s over the step, base frame
    fell: bool


class EngineBody:
    """An engine's robot as the control loop knows it, with notes of what happens."""

    def __init__(self, engine: Engine, metadata: dict[str, Any], feet: Feet):
        """Raises CampError for a control period that READING_S does not divide."""
        self._engine, self._feet, self._period = engine, feet, metadata["control_period"]
        self._readings = round(self._period / READING_S)
        if abs(self._readings * READING_S - self._period) > 1e-9:
            raise CampError(
                f"metadata control_period = {self._period:g}: no multiple of {READING_S:g} s; export a policy that was "
                "trained at one"
            )
        self._seen = [JOINT_NAMES.index(name) for name in metadata["joint_names"]]
        self._sent = [metadata["joint_names"].index(name) for name in JOINT_NAMES]
        self.state = engine.state()
        self.fell = False
        self.contact: list[NDArray[np.bool_]] = []
        self.foot_height: list[Floats] = []
        self.velocity: list[Floats] = []

    @property
    def joint_position(self) -> Array:
        return self.state.joint_position[self._seen].astype(np.float32)

    @property
    def joint_velocity(self) -> Array:
        return self.state.joint_velocity[self._seen].astype(np.float32)

    @property
    def angular_velocity(self) -> Array:
        return (self.state.rotation.T @ self.state.angular_velocity).astype(np.float32)

    @property
    def gravity(self) -> Array:
        return -self.state.rotation[2].astype(np.float32)

    def hold(self, target: Array) -> None:
        before = self.state.position
        self._engine.set_targets(target[self._sent].astype(np.float64))
        for _ in range(self._readings):
            self._engine.step()
            found = self._engine.contacts()
            self.contact.append(found.feet)
        self.state = self._engine.state()
        rotation = self.state.rotation
        travelled = rotation.T @ (self.state.position - before) / self._period
        self.velocity.append(np.array([*travelled[:2], (rotation.T @ self.state.angular_velocity)[2]]))
        self.foot_height.append(self._feet.heights(self.state.position, rotation, self.state.joint_position))
        upright = np.isfinite(self.state.joint_position).all() and rotation[2, 2] > np.cos(FALL_TILT)
        self.fell = found.fallen or not upright


class Feet:
    """Where the feet are, from the base and the joints alone: the same for every engine."""

    def __init__(self, robot: Robot):
        self._model = fused_model(robot)
        self._data = mujoco.MjData(self._model)
        self._joints = [self._model.joint(name).qposadr[0] for name in JOINT_NAMES]
        self._geoms = [self._model.geom(f"{foot}_foot").id for foot in FOOT_NAMES]

    def heights(self, position: Floats, rotation: Floats, joint_position: Floats) -> Floats:
        """(4,) m, lowest point of each foot above the ground."""
        self._data.qpos[:3] = position
        mujoco.mju_mat2Quat(self._data.qpos[3:7], np.ascontiguousarray(rotation, dtype=np.float64).ravel())
        self._data.qpos[self._joints] = joint_position
        mujoco.mj_kinematics(self._model, self._data)
        return self._data.geom_xpos[self._geoms, 2] - self._model.geom_size[self._geoms, 0]


def walk(policy: Policy, body: EngineBody, skill: str, command: Sequence[float], seconds: float) -> Walk:
    """Walk from where the body stands until the time is over or the robot falls.

    command: vx, vy in m/s, yaw rate in rad/s. Raises CampError for a skill that the policy does not know, and for an
    answer that is not finite.
    """
    steps = round(seconds / policy.metadata["control_period"])
    for _ in islice(control(policy, body, skill, command), steps):
        if body.fell:
            break
    return Walk(np.array(body.contact), np.array(body.foot_height), np.array(body.velocity), body.fell)
