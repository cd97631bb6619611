"""The robot that the suite judges: a suite for another one would be another suite, with other numbers."""

from __future__ import annotations

from camp.robots.registry import find_robot

ROBOT = find_robot("go2")
