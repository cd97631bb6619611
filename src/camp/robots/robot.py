"""A robot as an object: its model file and the physical constants that go with it.

Whoever needs a robot's numbers is given the ``Robot``; there is no current one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np

from camp.common.mujoco_log import no_log_file
from camp.robots.quadruped import NUM_JOINTS

PerJoint = tuple[float, ...]  # 12 values in the order of JOINT_NAMES


@dataclass(frozen=True)
class LegGeometry:
    """Lengths in m of four equal legs; the hips mirrored left to right and front to rear."""

    hip_x: float  # hip joint ahead of (front) or behind (rear) the base origin
    hip_y: float  # hip joint left or right of the base origin
    hip_offset: float  # thigh joint outward of the hip joint
    thigh_length: float  # thigh joint to calf joint
    calf_length: float  # calf joint to the foot's centre, along the calf
    foot_offset_x: float  # foot's centre ahead of the calf's axis
    foot_radius: float

    @cached_property
    def shank(self) -> float:
        """Calf joint to the foot's centre in a straight line, m."""
        return math.hypot(self.calf_length, self.foot_offset_x)

    @cached_property
    def shank_angle(self) -> float:
        """Angle in rad by which that line leans behind the calf's axis."""
        return math.atan2(-self.foot_offset_x, self.calf_length)


@dataclass(frozen=True)
class Robot:
    """One quadruped. Joint values are in the order of JOINT_NAMES."""

    name: str  # in the configuration and in file names
    title: str  # in texts
    model_path: Path  # MuJoCo model on flat ground; docs/extending.md lists the names that it must have
    mass: float  # kg, of the whole robot, rounded: the size of pushes
    leg: LegGeometry
    default_joint_position: PerJoint  # rad, standing pose theta_init of the paper's action
    standing_height: float  # m, base above ground in the default pose, feet just touching
    joint_lower: PerJoint  # rad
    joint_upper: PerJoint  # rad
    torque_limit: PerJoint  # N m
    joint_speed_limit: PerJoint  # rad/s
    pd_gain_p: PerJoint  # N m/rad
    pd_gain_d: PerJoint  # N m s/rad
    walking_com_height: float  # m, centre of mass above the ground in the expert's gaits
    largest_foot_force: float  # N, upward on one foot in the expert's plans

    def load_spec(self) -> mujoco.MjSpec:
        """The editable model: robot on flat ground, one PD position actuator per joint, contact-force sensors."""
        no_log_file()
        return mujoco.MjSpec.from_file(str(self.model_path))

    def load_model(self, timestep: float = 0.005) -> mujoco.MjModel:
        """The learner's model: PD position actuators with this robot's gains, clipped at the torque limits.

        Args:
            timestep: physics step in s.
        """
        spec = self.load_spec()
        spec.option.timestep = timestep
        model = spec.compile()
        model.actuator_gainprm[:, 0] = self.pd_gain_p
        model.actuator_biasprm[:, 1] = -np.array(self.pd_gain_p)
        model.actuator_biasprm[:, 2] = -np.array(self.pd_gain_d)
        return model

    def load_torque_model(self, timestep: float = 0.005) -> mujoco.MjModel:
        """The same robot with plain torque motors (``ctrl`` in N m), for controllers that compute torques."""
        spec = self.load_spec()
        spec.option.timestep = timestep
        for actuator, limit in zip(spec.actuators, self.torque_limit, strict=True):
            actuator.set_to_motor()
            actuator.forcerange = [-limit, limit]
        for key in spec.keys:
            key.ctrl = [0.0] * NUM_JOINTS
        return spec.compile()
