"""The `motion.npy` of Kine2Go: (T, 61) at 60 Hz, the state of a Go2 in Genesis.

    0..17   dofs_position: base position 3, base angles 3, joints 12
    18..35  dofs_velocity, likewise
    36..47  foot positions, m, world, FL, RL, FR, RR
    48..50  base position, m, world             55..57  base linear velocity, m/s, world
    51..54  base quaternion, w x y z            58..60  base angular velocity, rad/s, world

The layout stands in the data set's `metadata.json` and in `dump_state` of its pipeline (nomagiclab/kine2go-pipeline,
motion_retargeting/env.py). The sources disagree on the joints: the metadata names FR, FL, RR, RL leg by leg, while
the pipeline dumps the simulator's own order, which a user of the data (kairoi-k/kine2go-research) found to be all
hips, then all thighs, then all calves of FL, FR, RL, RR. So the file's own feet decide between the two.

Velocities are differentiated from the positions: the file's own are backward differences that begin with a zero,
and zero throughout where the source had no time stamps.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from camp.common.errors import ClipError
from camp.motion.exchange.feet import feet_of, mean_distance
from camp.motion.exchange.motion import ImportOptions, Motion, by_leg, w_first
from camp.motion.exchange.rotations import continuous, rotate_inverse
from camp.motion.exchange.tables import check_table, check_unit, load_npy
from camp.robots.quadruped import FOOT_NAMES
from camp.robots.robot import Robot

RATE_HZ = 60.0
LEG_ORDER = ("FR", "FL", "RR", "RL")
FOOT_ORDER = ("FL", "RL", "FR", "RR")
NUM_COLUMNS = 61
QUATERNION_ORDER = "wxyz"
_SAME_POSITION = 1e-3  # m


def read_kine2go(path: Path, options: ImportOptions) -> Motion:
    """Read a motion.npy of Kine2Go. Raises ClipError where it is not one."""
    table = check_table(load_npy(path), NUM_COLUMNS, "the array")
    apart = float(np.abs(table[:, :3] - table[:, 48:51]).max())
    if apart > _SAME_POSITION:
        raise ClipError(
            f"columns 0..2 and 48..50 both hold the base position in Kine2Go's layout, but differ by {apart:.3f} m; "
            "pass another --format"
        )
    check_unit(table[:, 51:55])
    quaternion_order = options.quaternion_order or QUATERNION_ORDER
    quaternion = continuous(w_first(table[:, 51:55], quaternion_order))
    foot_order = options.foot_order or FOOT_ORDER
    world = by_leg(table[:, 36:48], foot_order).reshape(-1, 4, 3)
    foot_position = rotate_inverse(quaternion[:, None], world - table[:, None, 48:51])
    joints, leg_order = _joints(options.robot, table[:, 6:18], foot_position, options.leg_order)
    return Motion(
        rate_hz=RATE_HZ if options.rate_hz is None else options.rate_hz,
        base_position=table[:, 48:51],
        base_quaternion=quaternion,
        quaternion_order=quaternion_order,
        joint_position=joints,
        foot_position=foot_position,
        leg_order=leg_order,
        foot_order=foot_order,
    )


def _joints(
    robot: Robot, columns: np.ndarray, foot_position: np.ndarray, order: tuple[str, ...] | None
) -> tuple[np.ndarray, tuple[str, ...]]:
    """(N, 12) in the project's order, and the file's: of leg by leg and kind by kind what comes nearer to the feet."""
    by_kind = columns.reshape(-1, 3, 4).swapaxes(1, 2).reshape(-1, 12)  # (kind, leg) to (leg, kind)
    orders = (order or LEG_ORDER, order or FOOT_NAMES)
    readings = [(by_leg(block, legs), legs) for block, legs in zip((columns, by_kind), orders, strict=True)]
    return min(readings, key=lambda reading: mean_distance(feet_of(robot, reading[0]), foot_position))
