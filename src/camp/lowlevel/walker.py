"""The policy's part of a control step: readings and the operator's orders in, joint targets out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camp.common.errors import CampError
from camp.deployment.loop import Memory, Policy
from camp.lowlevel.messages import Array, Reading
from camp.lowlevel.state_machine import Body
from camp.robots.quadruped import JOINT_NAMES
from camp.robots.registry import find_robot


@dataclass(frozen=True)
class _Ordered:
    """A reading with its joints in the order of the policy."""

    joint_position: Array
    joint_velocity: Array
    angular_velocity: Array
    gravity: Array


class Walker:
    """One policy and its memory, the last action."""

    def __init__(self, policy: Policy):
        self.policy = policy
        metadata = policy.metadata
        self._order = np.array([JOINT_NAMES.index(name) for name in metadata["joint_names"]])
        self._memory = Memory(policy)

    @property
    def period_s(self) -> float:
        """Between two targets."""
        return float(self.policy.metadata["control_period"])

    def body(self) -> Body:
        """What the states need of the policy and its robot, in the order of JOINT_NAMES."""
        metadata = self.policy.metadata
        robot = find_robot(metadata["robot"])
        pose, kp, kd = (self._joints(metadata[key]) for key in ("default_pose", "kp", "kd"))
        return Body(pose, kp, kd, np.array(robot.joint_lower, np.float32), np.array(robot.joint_upper, np.float32))

    def start(self) -> None:
        """Forget the last action: the robot stands in the default pose."""
        self._memory.clear()

    def target(self, reading: Reading, skill: str, velocity: Sequence[float]) -> Array | None:
        """(12,) rad in the order of JOINT_NAMES; None where the policy's answer is no number.

        velocity: vx, vy in m/s, yaw rate in rad/s.
        """
        ordered = _Ordered(
            joint_position=reading.joint_position[self._order],
            joint_velocity=reading.joint_velocity[self._order],
            angular_velocity=reading.angular_velocity,
            gravity=reading.gravity,
        )
        try:
            return self._joints(self._memory.target(ordered, skill, velocity))
        except CampError:
            return None

    def _joints(self, values: Sequence[float] | Array) -> Array:
        """From the policy's order to that of JOINT_NAMES."""
        joints = np.empty(len(self._order), np.float32)
        joints[self._order] = values
        return joints
