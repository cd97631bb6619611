"""Files as other projects write them, made from the shipped clips, and what can be wrong with them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from camp.common.paths import assets_root
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.exchange.convert import import_motion, resample
from camp.motion.exchange.exporter import export_amp
from camp.motion.exchange.feet import feet_of
from camp.motion.exchange.motion import ImportOptions, Motion, Velocities
from camp.motion.exchange.rotations import continuous, multiply, rotate, rotate_inverse
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES

FOLDER = assets_root() / "motions" / "go2"
NAMES = ("trot_2hz_forward_0.6", "pace_3hz_turn_left_0.6", "bound_2hz_left_0.25", "pronk_2hz_forward_0.6")
TROT = ImportOptions(GO2, gait="trot")
HALF_TURN = np.array([0.0, 0.0, 0.0, 1.0])  # about z


def shipped(name: str = NAMES[0]) -> Clip:
    return load_clip(FOLDER / f"{name}.npz")


def qpos_of(clip: Clip) -> np.ndarray:
    return np.concatenate([clip.base_position, clip.base_quaternion, clip.joint_position], axis=1).astype(np.float64)


def motion_of(clip: Clip) -> Motion:
    table = qpos_of(clip)
    return Motion(1.0 / clip.dt, table[:, :3], continuous(table[:, 3:7]), table[:, 7:])


def write_qpos(path: Path, table: np.ndarray) -> Path:
    np.save(path, table)
    return path


def edit(path: Path, **changes: object) -> Path:
    """Replace entries of an AMP file; a function is applied to the frames."""
    content = json.loads(path.read_text())
    for name, value in changes.items():
        content[name] = value(np.array(content[name])).tolist() if callable(value) else value
    path.write_text(json.dumps(content))
    return path


def resampled_table(clip: Clip, rate: float) -> np.ndarray:
    motion = resample(motion_of(clip), rate)
    return np.concatenate([motion.base_position, motion.base_quaternion, motion.joint_position], axis=1)


def amp_frames(clip: Clip, rate: float, forward_differences: bool) -> list[list[float]]:
    """A clip at another rate in the text format; five decimals and no foot velocities, as files have them."""
    motion = resample(motion_of(clip), rate)
    velocities = motion.velocities
    assert velocities is not None
    if forward_differences:
        linear = rotate_inverse(motion.base_quaternion[:-1], np.diff(motion.base_position, axis=0) * rate)
        joint = np.diff(motion.joint_position, axis=0) * rate
        velocities = Velocities(joint, linear, velocities.base_angular[:-1])
    rows = len(velocities.joint)
    legs = [FOOT_NAMES.index(leg) for leg in ("FR", "FL", "RR", "RL")]
    blocks = [motion.joint_position, feet_of(GO2, motion.joint_position), velocities.joint, np.zeros((rows, 12))]
    joints, feet, speeds, zero = (b[:rows].reshape(rows, 4, 3)[:, legs].reshape(rows, 12) for b in blocks)
    base = [motion.base_position[:rows], motion.base_quaternion[:rows, [1, 2, 3, 0]]]
    twist = [velocities.base_linear, velocities.base_angular]
    return np.concatenate([*base, joints, feet, *twist, speeds, zero], axis=1).round(5).tolist()


def kine2go_table(clip: Clip, joints_by_kind: bool) -> np.ndarray:
    """A file as Kine2Go's pipeline dumps it, at 60 Hz."""
    motion = resample(motion_of(clip), 60.0)
    assert motion.velocities is not None
    legs = motion.joint_position.reshape(-1, 4, 3)
    joints = legs.swapaxes(1, 2) if joints_by_kind else legs[:, [1, 0, 3, 2]]
    local = feet_of(GO2, motion.joint_position)
    world = motion.base_position[:, None] + rotate(motion.base_quaternion[:, None], local)
    feet = world[:, [FOOT_NAMES.index(leg) for leg in ("FL", "RL", "FR", "RR")]]
    rows = len(motion)
    parts = [
        motion.base_position,
        np.zeros((rows, 3)),
        joints.reshape(rows, 12),
        np.zeros((rows, 18)),
        feet.reshape(rows, 12),
        motion.base_position,
        motion.base_quaternion,
        np.zeros((rows, 6)),
    ]
    return np.concatenate(parts, axis=1).astype(np.float32)


def swap_legs(frames: np.ndarray) -> np.ndarray:
    """FR, FL, RR, RL to FL, FR, RL, RR, as later forks write them."""
    for start in (7, 19, 37, 49):
        block = frames[:, start : start + 12].reshape(-1, 4, 3)[:, [1, 0, 3, 2]]
        frames[:, start : start + 12] = block.reshape(-1, 12)
    return frames


def in_world(frames: np.ndarray) -> np.ndarray:
    """Turned to face backward, with root velocities in the world frame."""
    quaternion = multiply(np.broadcast_to(HALF_TURN, (len(frames), 4)), frames[:, [6, 3, 4, 5]])
    frames[:, 3:7] = quaternion[:, [1, 2, 3, 0]]
    frames[:, :2] *= -1.0
    for columns in (slice(31, 34), slice(34, 37)):
        frames[:, columns] = rotate(quaternion, frames[:, columns])
    return frames


def spoiled(columns: slice, change: float, frame: slice = slice(None)) -> object:
    def spoil(frames: np.ndarray) -> np.ndarray:
        frames[frame, columns] = frames[frame, columns] * change if np.isfinite(change) else change
        return frames

    return spoil


def imported_folder(folder: Path) -> Path:
    for name in ("trot_2hz_forward_0.6", "pace_2hz_in_place", "bound_3hz_forward_0.6", "pronk_3hz_in_place"):
        clip = shipped(name)
        export_amp(folder / "amp.txt", clip)
        save_clip(folder / f"{name}.npz", import_motion(folder / "amp.txt", "amp", ImportOptions(GO2, gait=clip.gait)))
    return folder
