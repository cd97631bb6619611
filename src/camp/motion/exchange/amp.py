"""The text format of AMP quadruped code: a JSON object with `FrameDuration` in s and `Frames` of 61 numbers,
or of the first 19 of them (DeepMimic's style, without feet and velocities).

    0..2    root position, m, world              34..36  root angular velocity, rad/s
    3..6    root quaternion, x y z w             37..48  joint velocities, rad/s
    7..18   joint positions, rad                 49..60  foot velocities, m/s, base frame
    19..30  foot positions, m, base frame
    31..33  root linear velocity, m/s

Root velocities are in the BASE frame: the script that made the published files (`retarget_kp_motions.py` of
AMP_for_hardware and its forks) rotates both into it, and the numbers of published files agree; others are read with
`velocity_frames`, linear and angular. All velocities there are differences to the next frame, half a
frame late: where a file's are, they are differentiated anew; true ones are kept.

Legs are FR, FL, RR, RL (PyBullet's order: the loader's `reorder_from_pybullet_to_isaac`); later forks retarget in
the order FL, FR, RL, RR, or only their joints, and their files look the same otherwise, so the feet are compared
with the joints.
`LoopMode` and `MotionWeight` are not used: clips have ends, and the sampler balances the skills. Foot velocities
are computed from the joints (some files hold zeros).
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from camp.common.errors import ClipError
from camp.common.foreign import foreign_file
from camp.motion.exchange.motion import ImportOptions, Motion, Velocities, by_leg, w_first
from camp.motion.exchange.rotations import continuous, rotate_inverse
from camp.motion.exchange.tables import check_table, check_unit

LEG_ORDER = ("FR", "FL", "RR", "RL")
QUATERNION_ORDER = "xyzw"
COLUMNS = {
    "root position": slice(0, 3),
    "root quaternion": slice(3, 7),
    "joint positions": slice(7, 19),
    "foot positions": slice(19, 31),
    "root linear velocity": slice(31, 34),
    "root angular velocity": slice(34, 37),
    "joint velocities": slice(37, 49),
    "foot velocities": slice(49, 61),
}
NUM_COLUMNS, NUM_POSITIONS = 61, 19
_REMEDY = "pass an AMP motion file"


def read_amp(path: Path, options: ImportOptions) -> Motion:
    """Read an AMP text file. Raises ClipError where it is not one."""
    with foreign_file(path, "cannot be read as JSON", _REMEDY, ClipError):
        content = json.loads(path.read_text(encoding="utf-8-sig"))
    _check_keys(content)
    frames = _frames(content["Frames"])
    table = check_table(frames, frames.shape[1], "Frames")
    check_unit(table[:, COLUMNS["root quaternion"]])
    quaternion_order = options.quaternion_order or QUATERNION_ORDER
    leg_order = options.leg_order or LEG_ORDER
    motion = Motion(
        rate_hz=_rate(content["FrameDuration"]) if options.rate_hz is None else options.rate_hz,
        base_position=table[:, COLUMNS["root position"]],
        base_quaternion=continuous(w_first(table[:, COLUMNS["root quaternion"]], quaternion_order)),
        quaternion_order=quaternion_order,
        joint_position=by_leg(table[:, COLUMNS["joint positions"]], leg_order),
        velocity_frames=options.velocity_frames,
        leg_order=leg_order,
        foot_order=options.foot_order or leg_order,
    )
    return motion if table.shape[1] == NUM_POSITIONS else _with_feet_and_velocities(motion, table)


def _check_keys(content: Any) -> None:
    if not isinstance(content, dict):
        raise ClipError(f"holds a JSON {type(content).__name__}; pass an object with 'FrameDuration' and 'Frames'")
    for key in ("FrameDuration", "Frames"):
        if key not in content:
            found = ", ".join(list(content)[:8]) or "none"
            raise ClipError(f"key '{key}' is missing (found: {found}); {_REMEDY}")


def _frames(frames: Any) -> np.ndarray:
    """(N, 61) or (N, 19)."""
    if not isinstance(frames, list) or not frames or not all(isinstance(frame, list) for frame in frames):
        raise ClipError("'Frames' is no list of lists; write one list of 61 or 19 numbers per frame")
    width = NUM_POSITIONS if len(frames[0]) == NUM_POSITIONS else NUM_COLUMNS
    for index, frame in enumerate(frames):
        if len(frame) != width:
            expected = f"{NUM_COLUMNS} or {NUM_POSITIONS}" if index == 0 else width
            raise ClipError(
                f"frame {index} of 'Frames' has {len(frame)} numbers, expected {expected}; repair the frame, or pass "
                "another --format"
            )
        for value in frame:
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise ClipError(
                    f"frame {index} of 'Frames' holds something that is no number ({str(value)[:20]!r}); repair it"
                )
    try:
        return np.array(frames, dtype=np.float64)
    except OverflowError as error:
        raise ClipError("'Frames' holds a whole number beyond all floats; repair it") from error


def _rate(duration: Any) -> float:
    number = isinstance(duration, int | float) and not isinstance(duration, bool)
    if not number or not 0.0 < duration < 1e6:
        raise ClipError(f"'FrameDuration' is {str(duration)[:20]!r}, expected seconds, more than 0; pass --rate HZ")
    return 1.0 / duration


def _with_feet_and_velocities(motion: Motion, table: np.ndarray) -> Motion:
    """What is all zero counts as absent."""
    foot_position = by_leg(table[:, COLUMNS["foot positions"]], motion.foot_order).reshape(-1, 4, 3)
    joint = by_leg(table[:, COLUMNS["joint velocities"]], motion.leg_order)
    root = [
        rotate_inverse(motion.base_quaternion, table[:, COLUMNS[name]]) if frame == "world" else table[:, COLUMNS[name]]
        for name, frame in zip(("root linear velocity", "root angular velocity"), motion.velocity_frames, strict=True)
    ]
    return replace(
        motion,
        foot_position=foot_position if foot_position.any() else None,
        velocities=Velocities(joint, *root) if joint.any() else None,
    )
