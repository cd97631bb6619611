"""Whole-body control: joint torques that realize planned forces and foot motions under the full dynamics.

One quadratic programme in the generalized accelerations (18) and the forces of the standing feet: the
floating base must obey its equations of motion, torques and friction have limits, everything else is a
weighted task.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camp.motion.expert.parameters import WholeBodyGains
from camp.motion.expert.rigid_body import GRAVITY_VECTOR, Constraints, friction_cone, solve_qp
from camp.motion.expert.robot_state import NUM_DOFS, RobotState
from camp.robots.robot import PerJoint

_BASE, _JOINTS, _ROTATION = slice(0, 6), slice(6, 18), slice(3, 6)


@dataclass(frozen=True)
class WholeBodyTask:
    """What to do now, world frame.

    standing: (4,) bool legs whose feet push; linear: (3,) CoM acceleration, m/s^2; angular: (3,) trunk
    acceleration, rad/s^2; foot: (4, 3) accelerations of the contact points, m/s^2; force: (4, 3) planned
    contact forces, N.
    """

    standing: np.ndarray
    linear: np.ndarray
    angular: np.ndarray
    foot: np.ndarray
    force: np.ndarray


def joint_torque(
    robot: RobotState, task: WholeBodyTask, mass: float, torque_limit: PerJoint, gains: WholeBodyGains
) -> np.ndarray:
    """Torques (12,) in N m for the task; `mass` in kg, limits in N m. Raises ValueError where no solution exists."""
    legs = np.flatnonzero(task.standing)
    size = NUM_DOFS + 3 * len(legs)
    acceleration, force = slice(0, NUM_DOFS), slice(NUM_DOFS, size)
    hessian, gradient = np.zeros((size, size)), np.zeros(size)

    def track(columns: slice, matrix: np.ndarray, goal: np.ndarray, weight: float) -> None:
        hessian[columns, columns] += weight * matrix.T @ matrix
        gradient[columns] -= weight * matrix.T @ goal

    if len(legs):
        total_force = np.tile(np.eye(3), len(legs)) / mass
        track(force, total_force, task.linear - GRAVITY_VECTOR, gains.linear_weight)
        hanging = ~robot.touching[legs]
        force_weight = np.repeat(np.where(hanging, gains.late_force_weight, gains.force_weight), 3)
        planned = np.where(hanging[:, None], 0.0, task.force[legs]).reshape(-1)
        hessian[force, force] += np.diag(force_weight)
        gradient[force] -= force_weight * planned
    angular_weight = gains.angular_weight if len(legs) else gains.flight_angular_weight
    track(_ROTATION, np.eye(3), robot.rotation.T @ task.angular, angular_weight)
    feet = robot.jacobian.reshape(-1, NUM_DOFS)
    track(acceleration, feet, (task.foot - robot.jacobian_drift).reshape(-1), gains.foot_weight)
    hessian[acceleration, acceleration] += gains.acceleration_weight * np.eye(NUM_DOFS)
    hessian += 1e-8 * np.eye(size)

    # Equations of motion: M qdd + bias - J' f = (0, torque)
    dynamics = np.hstack([robot.mass_matrix, -robot.jacobian[legs].reshape(-1, NUM_DOFS).T])
    to_torque, limit = dynamics[_JOINTS], gains.torque_fraction * np.array(torque_limit)
    cone, cone_bound = friction_cone(len(legs), gains.friction, 0.0, gains.largest_force)
    matrix = np.vstack([dynamics[_BASE], to_torque, -to_torque, np.hstack([np.zeros((len(cone), NUM_DOFS)), cone])])
    bias = robot.bias
    bound = np.concatenate([-bias[_BASE], -limit - bias[_JOINTS], -limit + bias[_JOINTS], cone_bound])
    solution = solve_qp(hessian, gradient, Constraints(matrix, bound, equalities=6))
    return to_torque @ solution + bias[_JOINTS]
