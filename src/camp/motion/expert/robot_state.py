"""The robot as the expert sees it: the full state of the simulation, nothing estimated."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from camp.motion.expert.rigid_body import RigidBody, roll_pitch_yaw, yaw_rotation
from camp.robots.quadruped import FOOT_NAMES

NUM_DOFS = 18  # floating base 6, joints 12
_CONTACT_GAP = 0.0005  # m above the floor at which a foot counts as standing on it
_STICTION_SPEED = 0.3  # rad/s, smooths the sign of a joint's dry friction


@dataclass(frozen=True)
class RobotState:
    """One instant in the world frame; the floor is z = 0.

    srb: (12,) SRB state, its angular velocity the centroidal one; rotation: (3, 3) base to world;
    trunk_rate: (3,) rad/s; foot: (4, 3) centres of the feet in m; contact_point: (4, 3) their lowest points in m;
    foot_velocity: (4, 3) of the contact point, m/s; touching: (4,) bool; jacobian: (4, 3, 18) of the contact points;
    jacobian_drift: (4, 3) m/s^2; mass_matrix: (18, 18); bias: (18,) forces that hold the robot against gravity,
    Coriolis and joint friction.
    """

    srb: np.ndarray
    rotation: np.ndarray
    trunk_rate: np.ndarray
    foot: np.ndarray
    contact_point: np.ndarray
    foot_velocity: np.ndarray
    touching: np.ndarray
    jacobian: np.ndarray
    jacobian_drift: np.ndarray
    mass_matrix: np.ndarray
    bias: np.ndarray


class StateReader:
    """Reads a RobotState out of MuJoCo data whose positions and velocities are up to date (mj_step1)."""

    def __init__(self, model: mujoco.MjModel, body: RigidBody, foot_radius: float) -> None:
        """foot_radius: of the feet's spheres, m."""
        self._model, self._foot_radius = model, foot_radius
        self._base = model.body("base").id
        self._foot_body = [model.body(f"{leg}_foot").id for leg in FOOT_NAMES]
        self._foot_geom = [model.geom(f"{leg}_foot").id for leg in FOOT_NAMES]
        self._dry_friction = model.dof_frictionloss[6:].copy()
        self._inverse_inertia = np.linalg.inv(body.inertia)

    def read(self, data: mujoco.MjData, near_yaw: float) -> RobotState:
        """`near_yaw` (rad) picks the branch of the yaw angle: the result lies within pi of it."""
        model = self._model
        mujoco.mj_subtreeVel(model, data)
        rotation = data.xmat[self._base].reshape(3, 3).copy()
        rpy = roll_pitch_yaw(rotation)
        rpy[2] = near_yaw + np.mod(rpy[2] - near_yaw + np.pi, 2 * np.pi) - np.pi
        level = yaw_rotation(rpy[2])
        centroidal_rate = level @ self._inverse_inertia @ level.T @ data.subtree_angmom[self._base]
        com, com_velocity = data.subtree_com[self._base], data.subtree_linvel[self._base]

        foot = data.geom_xpos[self._foot_geom].copy()
        contact_point = foot - [0.0, 0.0, self._foot_radius]
        jacobian = np.zeros((4, 3, NUM_DOFS))
        jacobian_rate = np.zeros((4, 3, NUM_DOFS))
        for leg, body in enumerate(self._foot_body):
            mujoco.mj_jac(model, data, jacobian[leg], None, contact_point[leg], body)
            mujoco.mj_jacDot(model, data, jacobian_rate[leg], None, contact_point[leg], body)
        mass_matrix = np.zeros((NUM_DOFS, NUM_DOFS))
        mujoco.mj_fullM(model, data, mass_matrix)
        bias = data.qfrc_bias - data.qfrc_passive
        bias[6:] += self._dry_friction * np.tanh(data.qvel[6:] / _STICTION_SPEED)
        return RobotState(
            srb=np.concatenate([rpy, com, centroidal_rate, com_velocity]),
            rotation=rotation,
            trunk_rate=rotation @ data.qvel[3:6],
            foot=foot,
            contact_point=contact_point,
            foot_velocity=jacobian @ data.qvel,
            touching=contact_point[:, 2] < _CONTACT_GAP,
            jacobian=jacobian,
            jacobian_drift=jacobian_rate @ data.qvel,
            mass_matrix=mass_matrix,
            bias=bias,
        )
