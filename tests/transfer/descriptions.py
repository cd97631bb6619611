"""Robots with the gains and the pose of the shipped policy's metadata."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from camp.common.paths import policies_root
from camp.robots.registry import find_robot
from camp.robots.robot import Robot
from camp.transfer.description import Description, describe

GO2, A1 = find_robot("go2"), find_robot("a1")


@cache
def metadata() -> dict[str, Any]:
    """policy.json of the shipped policy."""
    return json.loads((policies_root() / "go2_camp" / "policy.json").read_text())


@cache
def description(robot: Robot = GO2) -> Description:
    """With its gains and pose."""
    return describe(robot, metadata())
