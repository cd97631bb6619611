"""Robots by name: the only module that imports them one by one."""

from __future__ import annotations

from camp.common.errors import ConfigError
from camp.robots.a1 import A1
from camp.robots.go2 import GO2
from camp.robots.robot import Robot

ROBOTS: dict[str, Robot] = {robot.name: robot for robot in (GO2, A1)}
DEFAULT_ROBOT = GO2.name  # of run folders and exported policies that were written before robots had names


def find_robot(name: str, key: str = "robot.name") -> Robot:
    """The robot of that name. Raises ConfigError, naming ``key``, where there is none."""
    if name not in ROBOTS:
        raise ConfigError(
            f"{key} = {name!r}: unknown robot; choose one of {', '.join(ROBOTS)}, or add it (docs/extending.md)"
        )
    return ROBOTS[name]
