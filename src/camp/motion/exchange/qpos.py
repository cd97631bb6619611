"""Plain tables of MuJoCo's qpos, CSV or NPY: 19 numbers per frame and a frame rate that the caller knows.

    0..2   base position, m, world
    3..6   base quaternion, w x y z
    7..18  joint positions, rad, legs FL, FR, RL, RR (or `leg_order`), each hip, thigh, calf

A CSV's numbers are separated by commas, semicolons (then decimal commas are read, too), tabs or spaces. It may begin
with a line of names; the joints are then found by name (`FL_hip_joint`, ...). Velocities are differentiated.
"""

from __future__ import annotations

from pathlib import Path

from camp.common.errors import ClipError
from camp.motion.exchange.motion import ImportOptions, Motion, by_leg, w_first
from camp.motion.exchange.rotations import continuous
from camp.motion.exchange.tables import check_table, check_unit, joint_columns, load_csv, load_npy
from camp.robots.quadruped import FOOT_NAMES

NUM_COLUMNS = 19
QUATERNION_ORDER = "wxyz"


def read_qpos(path: Path, options: ImportOptions) -> Motion:
    """Read a table of qpos. Raises ClipError where it is not one or no rate is given."""
    if options.rate_hz is None:
        raise ClipError("a table of qpos does not carry its frame rate; pass --rate HZ")
    table, header = (load_npy(path), None) if path.suffix == ".npy" else load_csv(path)
    table = check_table(table, NUM_COLUMNS, "the table")
    check_unit(table[:, 3:7])
    quaternion_order = options.quaternion_order or QUATERNION_ORDER
    leg_order = FOOT_NAMES if header is not None else options.leg_order or FOOT_NAMES
    return Motion(
        rate_hz=options.rate_hz,
        base_position=table[:, :3],
        base_quaternion=continuous(w_first(table[:, 3:7], quaternion_order)),
        quaternion_order=quaternion_order,
        joint_position=by_leg(table[:, 7:] if header is None else table[:, joint_columns(header)], leg_order),
        leg_order=leg_order,
    )
