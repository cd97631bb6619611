"""How long each foot stands within the control steps of a clip, whose rows are too far apart to tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from scipy.spatial.transform import Rotation

from camp.motion.clips.clip import Clip
from camp.robots.robot import Robot
from camp.sim.base import InitialState
from camp.sim.cpu import CpuSimulator


def with_foot_stance(robot: Robot, clips: Sequence[Clip], physics_timestep: float) -> list[Clip]:
    """The clips with their ``foot_stance``: every row is simulated for one control step with its own joint targets.

    The row that follows gets what was seen; a clip's first row, and motion without targets of its own, get the contact
    that the clip has. robot: with the gains that the targets are made for; physics_timestep: s.
    """
    return [replace(clip, foot_stance=foot_stance(robot, clip, physics_timestep)) for clip in clips]


def foot_stance(robot: Robot, clip: Clip, physics_timestep: float) -> np.ndarray:
    """(T, 4) float32 fraction of the physics steps before each row of a clip in which each foot carried load."""
    stance = clip.foot_contact.astype(np.float32)
    if clip.has_targets:
        stance[1:] = _simulated(robot, clip, physics_timestep)[:-1]
    return stance


def _simulated(robot: Robot, clip: Clip, physics_timestep: float) -> np.ndarray:
    """(T, 4) the stance in the control step that begins with each row."""
    sim = CpuSimulator(robot, len(clip), clip.dt, physics_timestep, threads=1)
    try:
        sim.reset(torch.ones(len(clip), dtype=torch.bool), _initial(clip))
        sim.step(torch.from_numpy(clip.joint_target_applied))
        return sim.state.foot_stance.numpy()
    finally:
        sim.close()


def _initial(clip: Clip) -> InitialState:
    """Every row of the clip."""
    to_world = Rotation.from_quat(clip.base_quaternion, scalar_first=True)
    rows = {
        "base_position": clip.base_position,
        "base_quaternion": clip.base_quaternion,
        "base_linear_velocity": to_world.apply(clip.base_linear_velocity),
        "base_angular_velocity": clip.base_angular_velocity,
        "joint_position": clip.joint_position,
        "joint_velocity": clip.joint_velocity,
    }
    return InitialState(**{name: torch.from_numpy(values.astype(np.float32)) for name, values in rows.items()})
