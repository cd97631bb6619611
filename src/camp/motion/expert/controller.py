"""The expert's controller: gait schedule, reference, MPC, swing legs and whole-body control in one loop."""

from __future__ import annotations

import mujoco
import numpy as np

from camp.gaits.schedule import GaitSchedule
from camp.motion.expert.leg_momentum import LegMomentum
from camp.motion.expert.mpc import ForcePlan, ModelPredictiveController
from camp.motion.expert.parameters import ExpertParameters, expert_parameters
from camp.motion.expert.reference import PeriodicReference
from camp.motion.expert.rigid_body import ANGULAR, GRAVITY_VECTOR, LINEAR, POSITION, RPY, measure_body, yaw_rotation
from camp.motion.expert.robot_state import RobotState, StateReader
from camp.motion.expert.swing import SwingLegs, foothold_shift
from camp.motion.expert.target import MotionTarget
from camp.motion.expert.whole_body import WholeBodyTask, joint_torque
from camp.robots.robot import Robot

_LATE_DAMPING = np.array([20.0, 20.0, 30.0])  # 1/s, brings a hanging foot down without sliding


class GaitController:
    """Torques that make the robot walk a gait at a commanded twist, beginning from standing.

    Call `plan` once per control step and `torque` in every physics step after it.
    """

    def __init__(
        self,
        robot: Robot,
        data: mujoco.MjData,
        schedule: GaitSchedule,
        stand_duration: float,
        height: float = 0.0,
    ) -> None:
        """`data` holds the standing robot, forward kinematics done, heading along x.

        stand_duration: before the gait begins, s; height: of the CoM above the gait's usual one, m.
        """
        model = data.model
        base = model.body("base").id
        self.schedule = schedule
        self.parameters: ExpertParameters = expert_parameters(robot, schedule.gait, schedule.frequency_hz, height)
        self._robot, self._height = robot, height
        self.body = measure_body(model, data, base)
        self.leg_momentum = LegMomentum(schedule)
        self.reference = PeriodicReference(schedule, self.body, self.parameters.posture, self.parameters.reference)
        self.reference.solve(np.zeros(3), self.leg_momentum)
        com = data.subtree_com[base]
        self.target = MotionTarget(self.reference, com[2], stand_duration, robot.leg.foot_radius)
        self.target.heading[:2] = com[:2]
        self._reader = StateReader(model, self.body, robot.leg.foot_radius)
        self._mpc = ModelPredictiveController(self.body, self.parameters.mpc)
        self._swing = SwingLegs(schedule, self.parameters.swing, self.parameters.posture.swing_height)
        self._plan: ForcePlan | None = None
        self._stride = 0

    def succeed(self, data: mujoco.MjData, schedule: GaitSchedule, stand_duration: float) -> GaitController:
        """A controller of another gait that takes over on the way, at the twist walked.

        All feet stay down for `stand_duration` s before the new gait begins, so call it where a stride begins.
        """
        successor = GaitController(self._robot, data, schedule, stand_duration, self._height)
        successor.target.heading = self.target.heading.copy()
        successor.target.command = self.target.command
        successor.reference.solve(self.target.command, successor.leg_momentum)
        return successor

    def read(self, data: mujoco.MjData) -> RobotState:
        """The robot as the controller sees it; positions and velocities of `data` must be up to date."""
        return self._reader.read(data, near_yaw=self.target.heading[2])

    def plan(self, data: mujoco.MjData, command: np.ndarray) -> None:
        """Plan forces from the robot's state on; `command` (3,) is followed until the next call.

        Raises ValueError where no plan exists: the robot has fallen or will.
        """
        target = self.target
        target.command = command
        self._close_stride()
        robot = self.read(data)
        target.wait_for(robot.srb)
        self._plan = self._mpc.plan(robot.srb, robot.foot, target, self.leg_momentum, self._shift(robot))

    def torque(self, data: mujoco.MjData, duration: float) -> np.ndarray:
        """Joint torques (12,) in N m for the coming physics step of `duration` s; moves the clock on."""
        robot = self.read(data)
        if self.target.time >= 0.0:
            difference = robot.srb[ANGULAR] - robot.trunk_rate
            self.leg_momentum.observe(self.target.time, yaw_rotation(robot.srb[2]).T @ difference)
        torque = joint_torque(
            robot, self._task(robot), self.body.mass, self._robot.torque_limit, self.parameters.whole_body
        )
        self.target.advance(duration)
        return torque

    def _close_stride(self) -> None:
        """Fit the reference to the leg momentum and the command of the stride that begins."""
        stride = int(np.floor(self.target.time / self.schedule.period + 1e-6))
        if stride > self._stride:
            self._stride = stride
            self.leg_momentum.close_stride()
            self.reference.solve(self.target.command, self.leg_momentum, iterations=1)

    def _shift(self, robot: RobotState) -> np.ndarray:
        return foothold_shift(*self.target.error(robot.srb), self.parameters.swing)

    def _task(self, robot: RobotState) -> WholeBodyTask:
        if self._plan is None:
            raise RuntimeError("torque() was called before plan()")
        gains, time = self.parameters.whole_body, self.target.time
        planned, force, state = self._plan.state(time), self._plan.force(time), robot.srb
        level = yaw_rotation(state[2])

        linear = force.sum(0) / self.body.mass + GRAVITY_VECTOR
        linear += gains.linear_stiffness * (planned - state)[POSITION]
        linear += gains.linear_damping * (planned - state)[LINEAR]

        moment = np.cross(robot.contact_point - state[POSITION], force).sum(0)
        angular = level @ (np.linalg.inv(self.body.inertia) @ (level.T @ moment))
        # The plan speaks of the centroidal angular velocity; the trunk's is smaller by what the legs carry.
        angular -= level @ self.leg_momentum.rate(time)
        angular += gains.angular_stiffness * (level @ (planned - state)[RPY])
        trunk_rate = planned[ANGULAR] - level @ self.leg_momentum.at(time)
        angular += gains.angular_damping * (trunk_rate - robot.trunk_rate)

        standing = self.target.contact(time)
        return WholeBodyTask(standing, linear, angular, self._foot_acceleration(robot, standing), force)

    def _foot_acceleration(self, robot: RobotState, standing: np.ndarray) -> np.ndarray:
        gains, shift = self.parameters.whole_body, self._shift(robot)
        acceleration = np.empty((4, 3))
        for leg in range(4):
            if not standing[leg]:
                acceleration[leg] = self._swing.acceleration(leg, robot, self.target, shift)
                continue
            self._swing.land(leg)
            if robot.touching[leg]:
                acceleration[leg] = -gains.stance_damping * robot.foot_velocity[leg]
            else:
                acceleration[leg] = _LATE_DAMPING * ([0.0, 0.0, -gains.late_speed] - robot.foot_velocity[leg])
        return acceleration
