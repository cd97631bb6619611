"""One robot in MuJoCo as the control loop knows it: `camp.deployment.loop` reads it and tells it what to do."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np

from camp.common.errors import CampError
from camp.common.mujoco_log import no_log_file
from camp.deployment.loop import Array
from camp.robots.mujoco_robot import Joints, has_diverged, put_on_ground
from camp.robots.quadruped import CONTACT_FORCE, FOOT_NAMES
from camp.robots.registry import find_robot

FALL_TILT = 0.8  # rad, between the trunk's and the world's vertical


class Robot:
    """One simulated robot on flat ground, its joints in the order of the metadata's ``joint_names``."""

    def __init__(self, metadata: dict[str, Any]):
        """Raises CampError for a control period that the physics timestep does not divide."""
        no_log_file()
        self.model = mujoco.MjModel.from_xml_path(str(find_robot(metadata["robot"]).model_path))
        self.data = mujoco.MjData(self.model)
        self._joints = Joints.of(self.model, metadata["joint_names"])
        period, timestep = metadata["control_period"], self.model.opt.timestep
        self.substeps = round(period / timestep)
        if not math.isclose(self.substeps * timestep, period):
            raise CampError(
                f"metadata control_period = {period:g}: no multiple of the physics timestep, {timestep:g} s; export a "
                "policy that was trained at one"
            )
        self._joints.set_gains(self.model, metadata["kp"], metadata["kd"])
        self._pose = np.array(metadata["default_pose"])
        self.stand()

    def stand(self) -> None:
        """Put the robot on the ground, at rest in the default pose, its lowest foot just touching."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._joints.position] = self._pose
        self.data.ctrl[self._joints.motor] = self._pose
        put_on_ground(self.model, self.data)

    def hold(self, target: Array) -> None:
        """Hold joint targets (12,) in rad for one control period. Raises CampError where the simulation diverges."""
        self.aim(target)
        self.step(self.substeps)

    def aim(self, target: Array) -> None:
        """Hold joint targets (12,) in rad from now on."""
        self.data.ctrl[self._joints.motor] = target

    def step(self, count: int = 1) -> None:
        """Let ``count`` physics timesteps pass. Raises CampError where the simulation diverges."""
        mujoco.mj_step(self.model, self.data, count)
        if has_diverged(self.data):
            raise CampError("the robot's state is not finite: the simulation diverged; check the metadata's kp and kd")

    def push(self, vx: float, vy: float) -> None:
        """Change the trunk's velocity at once, m/s in the world frame."""
        self.data.qvel[:2] += vx, vy

    @property
    def joint_position(self) -> Array:
        """(12,) rad."""
        return self.data.qpos[self._joints.position].astype(np.float32)

    @property
    def joint_velocity(self) -> Array:
        """(12,) rad/s."""
        return self.data.qvel[self._joints.velocity].astype(np.float32)

    @property
    def angular_velocity(self) -> Array:
        """(3,) rad/s, base frame: the gyroscope."""
        return self.data.qvel[3:6].astype(np.float32)

    @property
    def gravity(self) -> Array:
        """(3,) unit vector of gravity, base frame: from the attitude that an inertial unit estimates."""
        w, x, y, z = self.data.qpos[3:7].astype(np.float32)
        return np.array([2 * (w * y - x * z), -2 * (w * x + y * z), 2 * (x * x + y * y) - 1], np.float32)

    @property
    def velocity(self) -> Array:
        """(3,) vx, vy in m/s and yaw rate in rad/s, base frame. Measured, not observed."""
        linear, inverse = np.zeros(3), np.zeros(4)
        mujoco.mju_negQuat(inverse, self.data.qpos[3:7])
        mujoco.mju_rotVecQuat(linear, self.data.qvel[:3], inverse)
        return np.array([*linear[:2], self.data.qvel[5]], np.float32)

    @property
    def heading(self) -> float:
        """Of the trunk in the world, rad to the left of its x axis."""
        w, x, y, z = self.data.qpos[3:7]
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    def touches(self, part: str) -> bool:
        """Whether a foot ("FL"), the base ("base") or a thigh ("FL_thigh") presses on the ground."""
        return bool(np.linalg.norm(self.data.sensor(f"{part}_contact").data) > CONTACT_FORCE)

    @property
    def fallen(self) -> bool:
        """The base or a thigh on the ground, or the trunk tilted too far."""
        parts = ("base", *(f"{leg}_thigh" for leg in FOOT_NAMES))
        return any(map(self.touches, parts)) or bool(np.arccos(np.clip(-self.gravity[2], -1, 1)) > FALL_TILT)
