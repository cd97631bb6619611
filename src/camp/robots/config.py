"""Schema of conf/robot: which robot, the PD law and the action's scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from omegaconf import MISSING

from camp.common import checks
from camp.common.bounds import Within
from camp.robots.registry import DEFAULT_ROBOT, find_robot

Stiffness = Annotated[float, Within(0.01, 1e4, "N m/rad; hundreds of times a Go2's, which no timestep can follow")]
Damping = Annotated[float, Within(0.001, 1e3, "N m s/rad; hundreds of times a Go2's")]
ActionScale = Annotated[float, Within(0.001, 10.0, "rad; three times half a turn")]


@dataclass
class RobotConfig:
    """conf/robot: which robot, the PD law and the action's scale."""

    name: str = DEFAULT_ROBOT  # of camp.robots.registry
    kp: list[Stiffness] = MISSING  # N m/rad: hip, thigh, calf
    kd: list[Damping] = MISSING  # N m s/rad: hip, thigh, calf
    action_scale: ActionScale = MISSING  # rad per unit of the network's output

    def check(self) -> None:
        find_robot(self.name)
        for name in ("kp", "kd"):
            gains = list(getattr(self, name))
            checks.require(len(gains) == 3, f"robot.{name}", gains, "give three gains: hip, thigh, calf")
