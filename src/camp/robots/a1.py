"""Unitree A1. Lengths, masses and limits: Unitree's published robot description (a1_description) and datasheet.

The description's masses add up to 12.78 kg; the datasheet says 12 kg, and MuJoCo Menagerie's A1, which is made from an
older description, weighs 12.45 kg.
"""

from __future__ import annotations

from pathlib import Path

from camp.robots.quadruped import NUM_LEGS
from camp.robots.robot import LegGeometry, Robot

A1 = Robot(
    name="a1",
    title="Unitree A1",
    model_path=Path(__file__).with_name("a1.xml"),
    mass=12.8,
    leg=LegGeometry(  # a1_description, xacro/const.xacro
        hip_x=0.1805,
        hip_y=0.047,
        hip_offset=0.0838,
        thigh_length=0.2,
        calf_length=0.2,
        foot_offset_x=0.0,
        foot_radius=0.02,
    ),
    default_joint_position=(0.0, 0.9, -1.8) * NUM_LEGS,  # the Go2's; also MuJoCo Menagerie's "home"
    standing_height=0.269,
    joint_lower=(-0.8028515, -1.0471976, -2.6965337) * NUM_LEGS,  # a1_description: -46, -60, -154.5 degrees
    joint_upper=(0.8028515, 4.1887902, -0.9162979) * NUM_LEGS,  # a1_description: 46, 240, -52.5 degrees
    torque_limit=(33.5, 33.5, 33.5) * NUM_LEGS,  # a1_description
    joint_speed_limit=(21.0, 21.0, 21.0) * NUM_LEGS,  # a1_description
    pd_gain_p=(30.0, 30.0, 40.0) * NUM_LEGS,  # the Go2's: the paper says that the A1 needs no tuning
    pd_gain_d=(1.0, 1.0, 1.0) * NUM_LEGS,  # the Go2's
    walking_com_height=0.25,  # found by trial
    largest_foot_force=200.0,  # about what the knee's torque limit can push
)
