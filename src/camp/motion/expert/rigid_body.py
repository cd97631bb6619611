"""The single rigid body (SRB): a trunk with the robot's whole mass, moved by forces at massless legs' feet.

State (12,): roll-pitch-yaw, position of the centre of mass (CoM), angular velocity, CoM velocity; world
frame. The model is linear once the lever arms and the yaw are fixed, which makes planning a quadratic
programme (Di Carlo et al., "Dynamic locomotion in the MIT Cheetah 3 through convex model-predictive control",
IROS 2018).
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
import quadprog

from camp.robots.quadruped import GRAVITY

GRAVITY_VECTOR = np.array([0.0, 0.0, -GRAVITY])  # m/s^2
STATE_SIZE = 12
RPY, POSITION, ANGULAR, LINEAR = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)


@dataclass(frozen=True)
class RigidBody:
    """Mass (kg) and inertia (3, 3) about the CoM in the trunk's frame (kg m^2)."""

    mass: float
    inertia: np.ndarray


@dataclass(frozen=True)
class ContactPlan:
    """Which leg pushes in which control interval of a horizon of N intervals; C pairs in all.

    durations: (N,) s; interval: (C,) int; leg: (C,) int; lever: (C, 3) foot minus CoM in m.
    """

    durations: np.ndarray
    interval: np.ndarray
    leg: np.ndarray
    lever: np.ndarray


def measure_body(model: mujoco.MjModel, data: mujoco.MjData, base: int) -> RigidBody:
    """Lump the robot in the posture of `data` (kinematics up to date) into one body, inertia diagonal."""
    mass_matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass_matrix)
    rotation = data.xmat[base].reshape(3, 3)
    arm = rotation.T @ (data.subtree_com[base] - data.xpos[base])
    mass = float(model.body_subtreemass[base])
    about_origin = mass_matrix[3:6, 3:6]
    about_com = about_origin - mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return RigidBody(mass, np.diag(np.diag(about_com)))


def skew(vector: np.ndarray) -> np.ndarray:
    """Matrix of the cross product, (..., 3) -> (..., 3, 3): skew(a) @ b = a x b."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def yaw_rotation(yaw: float) -> np.ndarray:
    """Rotation (3, 3) about the vertical."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def roll_pitch_yaw(rotation: np.ndarray) -> np.ndarray:
    """Angles (3,) in rad of a rotation matrix, rotations about x, then y, then z of the world."""
    pitch = -np.arcsin(np.clip(rotation[2, 0], -1.0, 1.0))
    roll = np.arctan2(rotation[2, 1], rotation[2, 2])
    return np.array([roll, pitch, np.arctan2(rotation[1, 0], rotation[0, 0])])


def force_response(body: RigidBody, plan: ContactPlan, yaw: float) -> np.ndarray:
    """Effect of every contact force on the state at the end of every interval: (N, 12, 3 C).

    Forces are constant within an interval; rotation about roll and pitch is taken as small.
    """
    rotation = yaw_rotation(yaw)
    angular = rotation @ np.linalg.inv(body.inertia) @ rotation.T @ skew(plan.lever)  # (C, 3, 3)
    linear = np.broadcast_to(np.eye(3) / body.mass, angular.shape)
    ends = np.cumsum(plan.durations)[:, None]  # (N, 1)
    duration = plan.durations[plan.interval]  # (C,)
    middle = (np.cumsum(plan.durations) - plan.durations / 2)[plan.interval]  # (C,)
    acts = plan.interval[None, :] <= np.arange(len(plan.durations))[:, None]
    to_velocity = np.where(acts, duration, 0.0)  # (N, C)
    to_position = np.where(acts, duration * (ends - middle), 0.0)
    blocks = [
        np.einsum("nc,cab->nacb", to_position, rotation.T @ angular),
        np.einsum("nc,cab->nacb", to_position, linear),
        np.einsum("nc,cab->nacb", to_velocity, angular),
        np.einsum("nc,cab->nacb", to_velocity, linear),
    ]
    return np.concatenate(blocks, axis=1).reshape(len(plan.durations), STATE_SIZE, -1)


def free_response(state: np.ndarray, times: np.ndarray, yaw: float) -> np.ndarray:
    """States (N, 12) at `times` (N,) s after `state` (12,) when no foot pushes: free fall."""
    elapsed = times[:, None]
    free = np.tile(state, (len(times), 1))
    free[:, RPY] += elapsed * (yaw_rotation(yaw).T @ state[ANGULAR])
    free[:, POSITION] += elapsed * state[LINEAR] + elapsed**2 / 2 * GRAVITY_VECTOR
    free[:, LINEAR] += elapsed * GRAVITY_VECTOR
    return free


def friction_cone(count: int, friction: float, lower: float, upper: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows (6 count, 3 count) and bounds (6 count,) with rows @ forces >= bounds.

    Per force: the four faces of the friction pyramid, and lower <= normal force <= upper in N.
    """
    pyramid = [
        [1, 0, friction],
        [-1, 0, friction],
        [0, 1, friction],
        [0, -1, friction],
        [0, 0, 1],
        [0, 0, -1],
    ]
    return np.kron(np.eye(count), np.array(pyramid)), np.tile([0.0, 0.0, 0.0, 0.0, lower, -upper], count)


@dataclass(frozen=True)
class Constraints:
    """Linear constraints matrix @ x >= bound, the first `equalities` rows holding with equality."""

    matrix: np.ndarray
    bound: np.ndarray
    equalities: int = 0


def solve_qp(hessian: np.ndarray, gradient: np.ndarray, constraints: Constraints) -> np.ndarray:
    """Minimize x' H x / 2 + g' x under the constraints, H positive definite. ValueError if infeasible."""
    transposed = np.ascontiguousarray(constraints.matrix.T)
    return quadprog.solve_qp(hessian, -gradient, transposed, constraints.bound, constraints.equalities)[0]
