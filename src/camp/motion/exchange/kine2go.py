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
from camp.motion.exchange.motion import ImportOptions, Motion, by_leg
from camp.motion.exchange.rotations import continuous, rotate_inverse
from camp.motion.exchange.tables import check_table, check_unit, load_npy

RATE_HZ = 60.0
LEG_ORDER = ("FR", "FL", "RR", "RL")
FOOT_ORDER = ("FL", "RL", "FR", "RR")
NUM_COLUMNS = 61
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
    quaternion = continuous(table[:, 51:55])
    world = by_leg(table[:, 36:48], FOOT_ORDER).reshape(-1, 4, 3)
    foot_position = rotate_inverse(quaternion[:, None], world - table[:, None, 48:51])
    return Motion(
        rate_hz=options.rate_hz or RATE_HZ,
        base_position=table[:, 48:51],
        base_quaternion=quaternion,
        joint_position=_joints(table[:, 6:18], foot_position, options),
        foot_position=foot_position,
    )


def _joints(columns: np.ndarray, foot_position: np.ndarray, options: ImportOptions) -> np.ndarray:
    """(N, 12) in the project's order, read in that documented order whose feet come nearer to the file's."""
    if options.leg_order is not None:
        return by_leg(columns, options.leg_order)
    by_kind = columns.reshape(-1, 3, 4).swapaxes(1, 2).reshape(-1, 12)  # (kind, leg) to (leg, kind)
    readings = [by_leg(columns, LEG_ORDER), by_kind]
    return min(readings, key=lambda joints: mean_distance(feet_of(joints), foot_position))
