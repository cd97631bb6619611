"""Schema of conf/robot: which robot, the PD law and the action's scale."""

from __future__ import annotations

from dataclasses import dataclass

from omegaconf import MISSING

from camp.common import checks
from camp.robots.registry import DEFAULT_ROBOT, find_robot


@dataclass
class RobotConfig:
    """conf/robot: which robot, the PD law and the action's scale."""

    name: str = DEFAULT_ROBOT  # of camp.robots.registry
    kp: list[float] = MISSING  # N m/rad: hip, thigh, calf
    kd: list[float] = MISSING  # N m s/rad: hip, thigh, calf
    action_scale: float = MISSING  # rad per unit of the network's output

    def check(self) -> None:
        find_robot(self.name)
        for name in ("kp", "kd"):
            gains = list(getattr(self, name))
            holds = len(gains) == 3 and all(gain > 0 for gain in gains)
            checks.require(holds, f"robot.{name}", gains, "give three positive gains: hip, thigh, calf")
        checks.positive("robot.action_scale", self.action_scale)
