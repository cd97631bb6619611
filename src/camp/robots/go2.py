"""Unitree Go2: names, physical constants and the MuJoCo model.

Every array of the project that speaks of legs or joints is in the order of ``FOOT_NAMES`` and ``JOINT_NAMES``.
Lengths, masses and limits: Unitree's published robot description and datasheet.
"""

from __future__ import annotations

from pathlib import Path

import mujoco

MODEL_PATH = Path(__file__).with_name("go2.xml")

FOOT_NAMES = ("FL", "FR", "RL", "RR")
JOINT_KINDS = ("hip", "thigh", "calf")
JOINT_NAMES = tuple(f"{leg}_{kind}_joint" for leg in FOOT_NAMES for kind in JOINT_KINDS)
NUM_LEGS = len(FOOT_NAMES)
NUM_JOINTS = len(JOINT_NAMES)

DEFAULT_JOINT_POSITION = (0.0, 0.9, -1.8) * NUM_LEGS  # rad, standing pose theta_init of the paper's action
STANDING_HEIGHT = 0.289  # m, base above ground in the default pose, feet just touching

JOINT_LOWER = (-1.0472, -1.5708, -2.7227) * 2 + (-1.0472, -0.5236, -2.7227) * 2  # rad, go2_description
JOINT_UPPER = (1.0472, 3.4907, -0.83776) * 2 + (1.0472, 4.5379, -0.83776) * 2  # rad, go2_description
TORQUE_LIMIT = (23.7, 23.7, 45.43) * NUM_LEGS  # N m, go2_description
JOINT_SPEED_LIMIT = (30.1, 30.1, 15.70) * NUM_LEGS  # rad/s, go2_description

HIP_X = 0.1934  # m, hip joint ahead of (front) or behind (rear) the base origin
HIP_Y = 0.0465  # m, hip joint left or right of the base origin
HIP_OFFSET = 0.0955  # m, thigh joint outward of the hip joint
THIGH_LENGTH = 0.213  # m, thigh joint to calf joint
CALF_LENGTH = 0.213  # m, calf joint to the foot's centre, along the calf
FOOT_OFFSET_X = -0.002  # m, foot's centre behind the calf's axis
FOOT_RADIUS = 0.022  # m
GRAVITY = 9.81  # m/s^2, of the model
CONTACT_FORCE = 1.0  # N, least ground reaction that counts as contact

PD_GAIN_P = (30.0, 30.0, 40.0) * NUM_LEGS  # N m/rad, paper, "Action space"
PD_GAIN_D = (1.0, 1.0, 1.0) * NUM_LEGS  # N m s/rad, paper, "Action space"


def load_spec() -> mujoco.MjSpec:
    """The editable model: robot on flat ground, one PD position actuator per joint, contact-force sensors."""
    return mujoco.MjSpec.from_file(str(MODEL_PATH))


def load_model(timestep: float = 0.005) -> mujoco.MjModel:
    """The learner's model: PD position actuators clipped at the torque limits.

    Args:
        timestep: physics step in s.
    """
    spec = load_spec()
    spec.option.timestep = timestep
    return spec.compile()


def load_torque_model(timestep: float = 0.005) -> mujoco.MjModel:
    """The same robot with plain torque motors (``ctrl`` in N m), for controllers that compute torques."""
    spec = load_spec()
    spec.option.timestep = timestep
    for actuator, limit in zip(spec.actuators, TORQUE_LIMIT, strict=True):
        actuator.set_to_motor()
        actuator.forcerange = [-limit, limit]
    for key in spec.keys:
        key.ctrl = [0.0] * NUM_JOINTS
    return spec.compile()
