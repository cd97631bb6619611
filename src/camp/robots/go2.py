"""Unitree Go2. Lengths, masses and limits: Unitree's published robot description and datasheet."""

from __future__ import annotations

from pathlib import Path

from camp.robots.quadruped import NUM_LEGS
from camp.robots.robot import LegGeometry, Robot

GO2 = Robot(
    name="go2",
    title="Unitree Go2",
    model_path=Path(__file__).with_name("go2.xml"),
    mass=15.2,
    leg=LegGeometry(  # go2_description
        hip_x=0.1934,
        hip_y=0.0465,
        hip_offset=0.0955,
        thigh_length=0.213,
        calf_length=0.213,
        foot_offset_x=-0.002,
        foot_radius=0.022,
    ),
    default_joint_position=(0.0, 0.9, -1.8) * NUM_LEGS,
    standing_height=0.289,
    joint_lower=(-1.0472, -1.5708, -2.7227) * 2 + (-1.0472, -0.5236, -2.7227) * 2,  # go2_description
    joint_upper=(1.0472, 3.4907, -0.83776) * 2 + (1.0472, 4.5379, -0.83776) * 2,  # go2_description
    torque_limit=(23.7, 23.7, 45.43) * NUM_LEGS,  # go2_description
    joint_speed_limit=(30.1, 30.1, 15.70) * NUM_LEGS,  # go2_description
    pd_gain_p=(30.0, 30.0, 40.0) * NUM_LEGS,  # paper, "Action space"
    pd_gain_d=(1.0, 1.0, 1.0) * NUM_LEGS,  # paper, "Action space"
    walking_com_height=0.27,  # found by trial
    largest_foot_force=250.0,  # about what the knee's torque limit can push
)
