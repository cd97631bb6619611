"""Clips written in the text format of AMP quadruped code (its layout: `camp.motion.exchange.amp`)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from camp.common.errors import ClipError
from camp.common.files import write_text
from camp.motion.clips.clip import Clip
from camp.motion.exchange.amp import LEG_ORDER
from camp.robots.quadruped import FOOT_NAMES

FORMATS = ("amp",)


def export_amp(path: Path, clip: Clip) -> None:
    """Write a clip; legs FR, FL, RR, RL, root velocities in the base frame.

    Left out, for the format has no place for it: the command, contacts, targets and torques. Numbers are written
    so that reading them gives the same float32.
    """
    columns = [FOOT_NAMES.index(leg) for leg in LEG_ORDER]
    rows = len(clip)

    def in_order(values: np.ndarray) -> np.ndarray:
        return values.reshape(rows, 4, 3)[:, columns].reshape(rows, 12)

    frames = np.concatenate(
        [
            clip.base_position,
            clip.base_quaternion[:, [1, 2, 3, 0]],
            in_order(clip.joint_position),
            in_order(clip.foot_position),
            clip.base_linear_velocity,
            clip.base_angular_velocity,
            in_order(clip.joint_velocity),
            in_order(clip.foot_velocity),
        ],
        axis=1,
    ).astype(np.float32)
    head = {
        "LoopMode": "Clamp",  # the last frame does not lead to the first
        "FrameDuration": clip.dt,
        "EnableCycleOffsetPosition": True,
        "EnableCycleOffsetRotation": True,
        "MotionWeight": 1.0,
    }
    lines = ",\n".join("[" + ", ".join(str(value) for value in frame) + "]" for frame in frames)
    text = json.dumps(head, indent=0)[:-2] + ',\n"Frames": [\n' + lines + "\n]\n}\n"

    def read_back(written: Path) -> None:
        read = np.array(json.loads(written.read_text(encoding="utf-8"))["Frames"], dtype=np.float32)
        if not np.array_equal(read, frames):
            raise ClipError(f"{path}: not written, for it does not read as the clip's numbers")

    write_text(Path(path), text, read_back)
