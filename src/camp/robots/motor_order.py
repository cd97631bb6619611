"""The motors of Unitree's quadrupeds as their SDK numbers them: FR, FL, RR, RL, three to a leg."""

from __future__ import annotations

from camp.robots.quadruped import JOINT_KINDS

MOTOR_LEGS = ("FR", "FL", "RR", "RL")
MOTOR_NAMES = tuple(f"{leg}_{kind}_joint" for leg in MOTOR_LEGS for kind in JOINT_KINDS)  # motor 0 to 11
