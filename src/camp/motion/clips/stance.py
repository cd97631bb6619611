"""How long each foot stands within the control steps of a clip, whose rows are too far apart to tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch

from camp.common.errors import ClipError
from camp.motion.clips.clip import Clip
from camp.motion.clips.consistency import rotation_matrix
from camp.robots.robot import Robot
from camp.sim.base import InitialState
from camp.sim.cpu import CpuSimulator

# Of the joint that is furthest from the clip's next row, rad, median over the rows. Shipped clips have 1e-7, and up to
# 0.02 in single rows, where the robot is pushed or a foot slips; with gains of nine tenths it is 4e-3.
WRONG_RAD = 1e-3


def with_foot_stance(robot: Robot, clips: Sequence[Clip], physics_timestep: float) -> list[Clip]:
    """The clips with their ``foot_stance``, see `foot_stance`. Raises ClipError as that does."""
    return [replace(clip, foot_stance=foot_stance(robot, clip, physics_timestep)) for clip in clips]


def foot_stance(robot: Robot, clip: Clip, physics_timestep: float) -> np.ndarray:
    """(T, 4) float32 fraction of the physics steps before each row of a clip in which each foot carried load.

    Every row is simulated for one control step with its own joint targets, and the row that follows gets what was
    seen; the first row gets the clip's contacts. Pushes are not repeated. robot: with the gains that the targets are
    made for; physics_timestep: s. Raises ClipError for motion without targets of its own, and where the simulation does
    not lead to the clip's next rows.
    """
    named = f"clip of {clip.gait} at {clip.frequency_hz:g} Hz"
    if not clip.has_targets:
        raise ClipError(
            f"{named}, imported from {clip.source}: has no joint targets to tell how long its feet stand; choose "
            "env.foot_stance=false"
        )
    reached, seen = _simulated(robot, clip, physics_timestep)
    error = np.median(np.abs(reached[:-1] - clip.joint_position[1:]).max(axis=1))
    if not error <= WRONG_RAD:
        raise ClipError(
            f"{named}: its joint targets lead {error:.2g} rad away from its next rows; choose env.foot_stance=false, "
            f"or clips made for {robot.title} and a physics step of {physics_timestep:g} s"
        )
    return np.concatenate([clip.foot_contact[:1].astype(np.float32), seen[:-1]])


def _simulated(robot: Robot, clip: Clip, physics_timestep: float) -> tuple[np.ndarray, np.ndarray]:
    """After the control step that begins with each row: joints (T, 12) rad and stance (T, 4)."""
    sim = CpuSimulator(robot, len(clip), clip.dt, physics_timestep, threads=1)
    sim.reset(torch.ones(len(clip), dtype=torch.bool), _initial(clip))
    sim.step(torch.from_numpy(clip.joint_target_applied))
    return sim.state.joint_position.numpy(), sim.state.foot_stance.numpy()


def _initial(clip: Clip) -> InitialState:
    """Every row of the clip."""
    to_world = rotation_matrix(clip.base_quaternion)
    rows = {
        "base_position": clip.base_position,
        "base_quaternion": clip.base_quaternion,
        "base_linear_velocity": np.einsum("tij,tj->ti", to_world, clip.base_linear_velocity),
        "base_angular_velocity": clip.base_angular_velocity,
        "joint_position": clip.joint_position,
        "joint_velocity": clip.joint_velocity,
    }
    return InitialState(**{name: torch.from_numpy(values.astype(np.float32)) for name, values in rows.items()})
