"""The text format of AMP quadruped code: a JSON object with `FrameDuration` in s and `Frames` of 61 numbers.

    0..2    root position, m, world              34..36  root angular velocity, rad/s
    3..6    root quaternion, x y z w             37..48  joint velocities, rad/s
    7..18   joint positions, rad                 49..60  foot velocities, m/s, base frame
    19..30  foot positions, m, base frame
    31..33  root linear velocity, m/s

Root velocities are in the BASE frame: the script that made the published files (`retarget_kp_motions.py` of
AMP_for_hardware and its forks) rotates both into it, and the numbers of published files agree; a file with world
velocities is read with `velocity_frame="world"`. All velocities there are differences to the next frame, half a
frame late: where a file's are, they are differentiated anew; true ones are kept.

Legs are FR, FL, RR, RL (PyBullet's order: the loader's `reorder_from_pybullet_to_isaac`); later forks retarget in
the order FL, FR, RL, RR and their files look the same otherwise, so the feet are compared with the joints.
`LoopMode` and `MotionWeight` are not used: clips have ends, and the sampler balances the skills. Foot velocities
are computed from the joints (some files hold zeros).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from camp.common.errors import ClipError
from camp.motion.exchange.motion import ImportOptions, Motion, Velocities, by_leg
from camp.motion.exchange.rotations import continuous, rotate_inverse
from camp.motion.exchange.tables import check_table, check_unit

LEG_ORDER = ("FR", "FL", "RR", "RL")
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
NUM_COLUMNS = 61


def read_amp(path: Path, options: ImportOptions) -> Motion:
    """Read an AMP text file. Raises ClipError where it is not one."""
    content = _load(path)
    table = check_table(_frames(content["Frames"]), NUM_COLUMNS, "Frames")
    part = {name: table[:, columns] for name, columns in COLUMNS.items()}
    check_unit(part["root quaternion"])
    quaternion = continuous(part["root quaternion"][:, [3, 0, 1, 2]])
    order = options.leg_order or LEG_ORDER
    foot_position = by_leg(part["foot positions"], order).reshape(-1, 4, 3)
    return Motion(
        rate_hz=options.rate_hz or _rate(content["FrameDuration"]),
        base_position=part["root position"],
        base_quaternion=quaternion,
        quaternion_order="x y z w",
        joint_position=by_leg(part["joint positions"], order),
        velocities=_velocities(part, quaternion, options),
        foot_position=foot_position if foot_position.any() else None,
    )


def _load(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ClipError(f"cannot be read as JSON ({error}); pass an AMP motion file") from error
    if not isinstance(content, dict):
        raise ClipError(f"holds a JSON {type(content).__name__}; pass an object with 'FrameDuration' and 'Frames'")
    for key in ("FrameDuration", "Frames"):
        if key not in content:
            raise ClipError(f"key '{key}' is missing (found: {', '.join(content) or 'none'}); pass an AMP motion file")
    return content


def _frames(frames: Any) -> np.ndarray:
    if not isinstance(frames, list) or not all(isinstance(frame, list) for frame in frames):
        raise ClipError("'Frames' is no list of lists; write one list of 61 numbers per frame")
    for index, frame in enumerate(frames):
        if len(frame) != NUM_COLUMNS:
            raise ClipError(f"frame {index} of 'Frames' has {len(frame)} numbers, expected {NUM_COLUMNS}")
    try:
        return np.array(frames, dtype=np.float64).reshape(len(frames), NUM_COLUMNS)
    except (TypeError, ValueError) as error:
        raise ClipError(f"'Frames' holds something that is no number ({error}); repair the file") from error


def _rate(duration: Any) -> float:
    if isinstance(duration, bool) or not isinstance(duration, int | float) or not duration > 0.0:
        raise ClipError(f"'FrameDuration' is {duration!r}, expected seconds, more than 0; pass --rate")
    return 1.0 / duration


def _velocities(part: dict[str, np.ndarray], quaternion: np.ndarray, options: ImportOptions) -> Velocities | None:
    """The file's own, in the base frame; None where it holds only zeros."""
    linear, angular = part["root linear velocity"], part["root angular velocity"]
    if options.velocity_frame == "world":
        linear, angular = rotate_inverse(quaternion, linear), rotate_inverse(quaternion, angular)
    elif options.velocity_frame != "base":
        raise ClipError(f"velocity frame {options.velocity_frame!r}: pass base or world")
    joint = by_leg(part["joint velocities"], options.leg_order or LEG_ORDER)
    return Velocities(joint, linear, angular) if joint.any() else None
