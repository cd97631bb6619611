"""Schema of conf/robot: the PD law and the action's scale."""

from __future__ import annotations

from dataclasses import dataclass

from omegaconf import MISSING

from camp.common import checks


@dataclass
class RobotConfig:
    """conf/robot: the PD law and the action's scale."""

    kp: list[float] = MISSING  # N m/rad: hip, thigh, calf
    kd: list[float] = MISSING  # N m s/rad: hip, thigh, calf
    action_scale: float = MISSING  # rad per unit of the network's output

    def check(self) -> None:
        for name in ("kp", "kd"):
            gains = list(getattr(self, name))
            holds = len(gains) == 3 and all(gain > 0 for gain in gains)
            checks.require(holds, f"robot.{name}", gains, "give three positive gains: hip, thigh, calf")
        checks.positive("robot.action_scale", self.action_scale)
