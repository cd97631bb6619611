"""What must hold between a robot and its model, for any robot."""

from __future__ import annotations

import mujoco
import numpy as np

from camp.robots.quadruped import FOOT_NAMES, NUM_JOINTS
from camp.robots.robot import Robot


def random_joints(robot: Robot, count: int, seed: int = 0) -> np.ndarray:
    """(count, 12) rad within the joints' ranges."""
    rng = np.random.default_rng(seed)
    return rng.uniform(robot.joint_lower, robot.joint_upper, (count, NUM_JOINTS))


def mujoco_feet(model: mujoco.MjModel, joints: np.ndarray, base: np.ndarray | None = None) -> np.ndarray:
    """Centres of the feet (4, 3) in the base frame; base: position and quaternion (7,)."""
    data = mujoco.MjData(model)
    data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0] if base is None else base
    data.qpos[7:] = joints
    mujoco.mj_kinematics(model, data)
    feet = np.array([data.geom(f"{leg}_foot").xpos for leg in FOOT_NAMES])
    return (feet - data.body("base").xpos) @ data.body("base").xmat.reshape(3, 3)
