"""Convex model predictive control of the single rigid body over one stride."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camp.motion.expert.leg_momentum import LegMomentum
from camp.motion.expert.parameters import MpcWeights
from camp.motion.expert.rigid_body import (
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
from camp.motion.expert.target import MotionTarget

_SHORTEST_INTERVAL = 1e-4  # s


@dataclass(frozen=True)
class ForcePlan:
    """Contact forces (N, 4, 3) in N and SRB states (N + 1, 12) at `times` (N + 1,) in s; world frame."""

    times: np.ndarray
    states: np.ndarray
    forces: np.ndarray

    def _interval(self, time: float) -> int:
        index = int(np.searchsorted(self.times, time + 1e-6, side="right")) - 1
        return min(max(index, 0), len(self.forces) - 1)

    def force(self, time: float) -> np.ndarray:
        """Forces (4, 3) at `time`."""
        return self.forces[self._interval(time)]

    def state(self, time: float) -> np.ndarray:
        """Predicted SRB state (12,) at `time`, interpolated."""
        index = self._interval(time)
        start, end = self.times[index], self.times[index + 1]
        fraction = np.clip((time - start) / (end - start), 0.0, 1.0)
        return (1.0 - fraction) * self.states[index] + fraction * self.states[index + 1]


class ModelPredictiveController:
    """Plans forces that bring the SRB back to its reference, one stride ahead, on the schedule's grid."""

    def __init__(self, body: RigidBody, weights: MpcWeights) -> None:
        self._body, self._weights = body, weights

    def plan(
        self,
        state: np.ndarray,
        foot: np.ndarray,
        target: MotionTarget,
        leg_momentum: LegMomentum,
        shift: np.ndarray,
    ) -> ForcePlan:
        """Plan from `target.time` on.

        Args:
            state: (12,) SRB state now.
            foot: (4, 3) centres of the feet now, m.
            target: the motion to follow.
            leg_momentum: what the legs add to the angular velocity.
            shift: (3,) feedback that will be added to the coming footholds, m.

        Raises ValueError where no force plan exists.
        """
        weights = self._weights
        times = self._grid(target)
        contacts, feedforward = self._contacts(times, state, foot, target, shift)
        yaw = state[2]
        response = force_response(self._body, contacts, yaw)
        free = free_response(state, times[1:] - times[0], yaw)
        middle = (times[1:] + times[:-1]) / 2
        free[:, RPY] -= np.cumsum(leg_momentum.at(middle) * contacts.durations[:, None], axis=0)
        goal = np.array([target.state(time) for time in times[1:]])

        matrix = response.reshape(-1, response.shape[-1])
        weighted = np.tile(weights.state, len(middle))[:, None] * matrix
        hessian = matrix.T @ weighted + weights.force * np.eye(matrix.shape[1])
        gradient = -weighted.T @ (goal - free).reshape(-1) - weights.force * feedforward.reshape(-1)
        cone = friction_cone(len(contacts.leg), weights.friction, weights.smallest_force, weights.largest_force)
        solution = solve_qp(hessian, gradient, Constraints(*cone))

        states = np.empty((len(times), STATE_SIZE))
        states[0], states[1:] = state, response @ solution + free
        forces = np.zeros((len(middle), 4, 3))
        forces[contacts.interval, contacts.leg] = solution.reshape(-1, 3)
        return ForcePlan(times, states, forces)

    @staticmethod
    def _grid(target: MotionTarget) -> np.ndarray:
        """Times (N + 1,): now, then the grid's own, so that every interval has one set of standing legs."""
        schedule = target.schedule
        following = (schedule.grid_index(target.time) + 1) * schedule.grid_period
        if following - target.time < _SHORTEST_INTERVAL:
            following += schedule.grid_period
        return np.r_[target.time, following + np.arange(schedule.grid_steps) * schedule.grid_period]

    @staticmethod
    def _contacts(
        times: np.ndarray, state: np.ndarray, foot: np.ndarray, target: MotionTarget, shift: np.ndarray
    ) -> tuple[ContactPlan, np.ndarray]:
        """The contacts of the horizon and the reference's force (C, 3) for each.

        Levers are taken from the reference's CoM moved by today's position error, as if it lasted.
        """
        schedule = target.schedule
        position_error, _ = target.error(state)
        intervals, legs, levers, forces = [], [], [], []
        standing_since_now = np.ones(4, dtype=bool)
        for index, middle in enumerate((times[1:] + times[:-1]) / 2):
            contact = target.contact(middle)
            standing_since_now &= contact
            if not contact.any():
                continue
            com = target.state(middle)[POSITION] + position_error
            reference_force = target.forces(middle)
            phase = schedule.phase(middle)
            for leg in np.flatnonzero(contact):
                centre = foot[leg]
                if not standing_since_now[leg]:
                    centre = target.foothold(int(leg), middle - phase[leg] * schedule.period, shift)
                intervals.append(index)
                legs.append(leg)
                levers.append(centre - [0.0, 0.0, target.foot_radius] - com)
                forces.append(reference_force[leg])
        plan = ContactPlan(np.diff(times), np.array(intervals), np.array(legs), np.array(levers))
        return plan, np.array(forces)
