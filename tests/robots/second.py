"""A robot that differs from the Go2 in every number, for tests that nothing is taken from the Go2."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from camp.robots.go2 import GO2
from camp.robots.robot import LegGeometry, Robot

SECOND = "second"
_POSE = "0.05 0.85 -1.7 -0.05 0.85 -1.7 0.05 0.85 -1.7 -0.05 0.85 -1.7"
_CHANGES = (  # of go2.xml
    ('model="go2"', f'model="{SECOND}"'),
    ("0.1934", "0.205"),  # hips further apart
    ("0.0465", "0.05"),
    (' 0.0955 0"', ' 0.09 0"'),
    (' -0.0955 0"', ' -0.09 0"'),
    ('_calf" pos="0 0 -0.213"', '_calf" pos="0 0 -0.23"'),
    ('pos="-0.002 0 -0.213"', 'pos="-0.004 0 -0.22"'),
    ('type="sphere" size="0.022"', 'type="sphere" size="0.025"'),
    ('mass="6.921"', 'mass="8"'),
    ('kp="30" kv="1"', 'kp="35" kv="1.2"'),
    ('kp="40" kv="1"', 'kp="45" kv="1.2"'),
    ("-23.7 23.7", "-26 26"),
    ("-45.43 45.43", "-50 50"),
    ("-1.0472 1.0472", "-0.9 0.9"),
    ("-2.7227 -0.83776", "-2.6 -0.8"),
    ("-1.5708 3.4907", "-1.4 3.3"),
    ("-0.5236 4.5379", "-0.6 4.3"),
    ("0 0 0.289 1 0 0 0 0 0.9 -1.8 0 0.9 -1.8 0 0.9 -1.8 0 0.9 -1.8", f"0 0 0.322 1 0 0 0 {_POSE}"),
    ("0 0.9 -1.8 0 0.9 -1.8 0 0.9 -1.8 0 0.9 -1.8", _POSE),
)


def second_robot(folder: Path) -> Robot:
    """Write its model into ``folder``."""
    text = GO2.model_path.read_text(encoding="utf-8")
    for old, new in _CHANGES:
        assert old in text, old
        text = text.replace(old, new)
    path = folder / f"{SECOND}.xml"
    path.write_text(text, encoding="utf-8")
    pose = (0.05, 0.85, -1.7, -0.05, 0.85, -1.7)
    return replace(
        GO2,
        name=SECOND,
        title="second robot",
        model_path=path,
        mass=16.3,
        leg=LegGeometry(
            hip_x=0.205,
            hip_y=0.05,
            hip_offset=0.09,
            thigh_length=0.23,
            calf_length=0.22,
            foot_offset_x=-0.004,
            foot_radius=0.025,
        ),
        default_joint_position=pose * 2,
        standing_height=0.322,
        joint_lower=(-0.9, -1.4, -2.6) * 2 + (-0.9, -0.6, -2.6) * 2,
        joint_upper=(0.9, 3.3, -0.8) * 2 + (0.9, 4.3, -0.8) * 2,
        torque_limit=(26.0, 26.0, 50.0) * 4,
        joint_speed_limit=(25.0, 25.0, 14.0) * 4,
        pd_gain_p=(35.0, 35.0, 45.0) * 4,
        pd_gain_d=(1.2, 1.2, 1.2) * 4,
        walking_com_height=0.295,
        largest_foot_force=270.0,
    )
