"""The periodic reference motion: what a single rigid body does when it follows a gait at a constant twist.

The motion is a deviation from the heading frame (camp.motion.expert.heading), which travels with the command. Forces
and initial state come out of one quadratic programme whose last state must equal the first; lever arms depend
on the solution, so it is solved a few times.
"""

from __future__ import annotations

import numpy as np

from camp.gaits.schedule import GaitSchedule
from camp.motion.expert.leg_momentum import LegMomentum
from camp.motion.expert.parameters import Posture, ReferenceWeights
from camp.motion.expert.rigid_body import (
    ANGULAR,
    LINEAR,
    POSITION,
    RPY,
    STATE_SIZE,
    Constraints,
    ContactPlan,
    RigidBody,
    force_response,
    free_response,
    friction_cone,
    solve_qp,
)


def nominal_footholds(posture: Posture) -> np.ndarray:
    """Feet in mid-stance relative to the heading frame, (4, 3) in m, on the floor."""
    x, y = posture.foot_x, posture.foot_y
    return np.array([[x, y, 0.0], [x, -y, 0.0], [-x, y, 0.0], [-x, -y, 0.0]])


class PeriodicReference:
    """One stride of SRB motion and contact forces on the grid of the schedule, N intervals.

    states: (N + 1, 12) deviation from the heading frame, last row equal to the first;
    forces: (N, 4, 3) in N, zero for swinging legs.
    """

    def __init__(self, schedule: GaitSchedule, body: RigidBody, posture: Posture, weights: ReferenceWeights) -> None:
        self.schedule, self.body, self.posture, self.weights = schedule, body, posture, weights
        steps = schedule.grid_steps
        self.states = np.zeros((steps + 1, STATE_SIZE))
        self.states[:, 5] = posture.com_height
        self.forces = np.zeros((steps, 4, 3))
        middles = (np.arange(steps) + 0.5) * schedule.grid_period
        self._interval, self._leg = np.nonzero(schedule.contact(middles))
        self._smoothness = self._force_differences()

    def solve(self, command: np.ndarray, leg_momentum: LegMomentum, iterations: int = 4) -> None:
        """Fit the stride to a twist command (vx, vy, wz); starts from the previous solution's lever arms."""
        for _ in range(iterations):
            self._solve_once(command, leg_momentum)

    def deviation(self, time: float) -> np.ndarray:
        """State (12,) relative to the heading frame at `time` (s), interpolated."""
        place = np.mod(time * self.schedule.frequency_hz, 1.0) * self.schedule.grid_steps
        index = min(int(place), self.schedule.grid_steps - 1)
        fraction = place - index
        return (1.0 - fraction) * self.states[index] + fraction * self.states[index + 1]

    def force(self, time: float) -> np.ndarray:
        """Contact forces (4, 3) in N in the heading frame at `time` (s)."""
        return self.forces[self.schedule.grid_index(time) % self.schedule.grid_steps]

    def _contact_plan(self, command: np.ndarray) -> ContactPlan:
        schedule, count = self.schedule, self.schedule.grid_steps
        middle = (self._interval + 0.5) * schedule.grid_period
        since_midstance = schedule.phase(middle)[np.arange(len(self._leg)), self._leg] - schedule.duty / 2
        nominal = nominal_footholds(self.posture)[self._leg]
        travel = np.stack(
            [
                command[0] - command[2] * nominal[:, 1],
                command[1] + command[2] * nominal[:, 0],
                0 * nominal[:, 0],
            ],
            1,
        )
        foot = nominal - travel * (since_midstance * schedule.period)[:, None]
        com = (self.states[:-1, POSITION] + self.states[1:, POSITION])[self._interval] / 2
        return ContactPlan(np.full(count, schedule.grid_period), self._interval, self._leg, foot - com)

    def _solve_once(self, command: np.ndarray, leg_momentum: LegMomentum) -> None:
        weights, steps, step = self.weights, self.schedule.grid_steps, self.schedule.grid_period
        contacts = len(self._leg)
        forces, size = slice(0, 3 * contacts), 3 * contacts + STATE_SIZE
        times = np.arange(steps + 1) * step

        # states = response @ (forces, initial state) + drift
        response = np.zeros((steps + 1, STATE_SIZE, size))
        response[1:, :, forces] = force_response(self.body, self._contact_plan(command), yaw=0.0)
        response[:, :, 3 * contacts :] = np.eye(STATE_SIZE)
        response[:, RPY, 3 * contacts + ANGULAR.start : 3 * contacts + ANGULAR.stop] = times[:, None, None] * np.eye(3)
        response[:, POSITION, 3 * contacts + LINEAR.start :] = times[:, None, None] * np.eye(3)
        drift = free_response(np.zeros(STATE_SIZE), times, yaw=0.0)
        drift[1:, RPY] -= np.cumsum(leg_momentum.table, axis=0) * step

        level = np.zeros(STATE_SIZE)
        level[5] = self.posture.com_height
        cost = np.tile(weights.state, steps)
        matrix = response[:-1].reshape(-1, size)
        hessian = matrix.T @ (cost[:, None] * matrix) * step
        gradient = -matrix.T @ (cost * (level - drift[:-1]).reshape(-1)) * step
        hessian[forces, forces] += weights.force_change / step * self._smoothness
        hessian[forces, forces] += weights.force * step * np.eye(3 * contacts)
        hessian += 1e-9 * np.eye(size)

        periodic = response[-1].copy()
        periodic[:, 3 * contacts :] -= np.eye(STATE_SIZE)
        cone, bound = friction_cone(contacts, weights.friction, weights.smallest_force, weights.largest_force)
        cone = np.hstack([cone, np.zeros((len(cone), STATE_SIZE))])
        constraints = Constraints(np.vstack([periodic, cone]), np.r_[-drift[-1], bound], STATE_SIZE)
        solution = solve_qp(hessian, gradient, constraints)

        self.states = response @ solution + drift
        self.forces = np.zeros_like(self.forces)
        self.forces[self._interval, self._leg] = solution[forces].reshape(-1, 3)

    def _force_differences(self) -> np.ndarray:
        """Quadratic form (3 C, 3 C) of the change of each leg's force between neighbouring intervals, cyclic.

        A swinging leg's force counts as zero, so forces also rise from zero at touchdown and fall to it at
        lift-off.
        """
        steps = self.schedule.grid_steps
        column = np.full((steps, 4), -1)
        column[self._interval, self._leg] = np.arange(len(self._leg))
        rows = []
        for leg in range(4):
            for now, after in zip(column[:, leg], np.roll(column[:, leg], -1), strict=True):
                if now < 0 and after < 0:
                    continue
                row = np.zeros(len(self._leg))
                if now >= 0:
                    row[now] -= 1.0
                if after >= 0:
                    row[after] += 1.0
                rows.append(row)
        difference = np.array(rows)
        return np.kron(difference.T @ difference, np.eye(3))
