"""The policy's observation (45 + K) and the critic's privileged part, each as one table of named entries.

All entries are in SI units without scaling: the networks' running normalizers scale them, so that an exported policy
takes what sensors give.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs.config import NoiseConfig
from camp.envs.measurement import Measurement
from camp.robots import go2
from camp.sim.base import LINK_NAMES, Dynamics


@dataclass
class Situation:
    """All that observations are made of, for N robots at one moment."""

    measurement: Measurement
    command: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s
    last_action: Tensor  # (N, 12) network output of the previous step
    skill: Tensor  # (N, K) one-hot; zeros where an ablation hides it
    average_velocity: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s, as it is rewarded
    dynamics: Dynamics


@dataclass(frozen=True)
class Entry:
    """One row of an observation table."""

    name: str
    size: int
    unit: str
    frame: str
    read: Callable[[Situation], Tensor]
    noise: str | None = None  # the field of NoiseConfig that holds its half-width


def actor_entries(num_skills: int) -> tuple[Entry, ...]:
    """The policy's observation, 45 + K numbers (paper, "State Space": 48 as printed means K = 3)."""
    joints = go2.NUM_JOINTS
    return (
        Entry(
            "base_angular_velocity",
            3,
            "rad/s",
            "base",
            lambda s: s.measurement.angular_velocity,
            "angular_velocity_rad_s",
        ),
        Entry("gravity", 3, "1", "base", lambda s: s.measurement.gravity, "gravity"),
        Entry("command", 3, "m/s, m/s, rad/s", "base", lambda s: s.command),
        Entry(
            "joint_position",
            joints,
            "rad",
            "joint, from the default pose",
            lambda s: s.measurement.joint_position - constant(go2.DEFAULT_JOINT_POSITION, s.command),
            "joint_position_rad",
        ),
        Entry(
            "joint_velocity",
            joints,
            "rad/s",
            "joint",
            lambda s: s.measurement.joint_velocity,
            "joint_velocity_rad_s",
        ),
        Entry("last_action", joints, "1", "joint, in action scales", lambda s: s.last_action),
        Entry("skill", num_skills, "1", "one-hot", lambda s: s.skill),
    )


def privileged_entries() -> tuple[Entry, ...]:
    """x_t, what the critic sees besides: exact motion and the randomized parameters of Table I."""
    joints = go2.NUM_JOINTS
    return (
        Entry("base_linear_velocity", 3, "m/s", "base", lambda s: s.measurement.linear_velocity),
        Entry("base_height", 1, "m", "world", lambda s: s.measurement.base_position[:, 2:]),
        Entry("foot_contact", 4, "0 or 1", "-", lambda s: s.measurement.foot_contact.float()),
        Entry("average_velocity", 3, "m/s, m/s, rad/s", "base", lambda s: s.average_velocity),
        Entry("link_mass_scale", len(LINK_NAMES), "1", "-", lambda s: s.dynamics.link_mass_scale),
        Entry("payload_mass", 1, "kg", "-", lambda s: s.dynamics.payload_mass[:, None]),
        Entry("payload_position", 3, "m", "base", lambda s: s.dynamics.payload_position),
        Entry("friction", 1, "1", "-", lambda s: s.dynamics.friction[:, None]),
        Entry("motor_strength", joints, "1", "joint", lambda s: s.dynamics.motor_strength),
        Entry("kp_scale", joints, "1", "joint", lambda s: s.dynamics.kp_scale),
        Entry("kd_scale", joints, "1", "joint", lambda s: s.dynamics.kd_scale),
    )


def size(entries: tuple[Entry, ...]) -> int:
    """Numbers in an observation."""
    return sum(entry.size for entry in entries)


def position(entries: tuple[Entry, ...], name: str) -> slice:
    """Where the entry ``name`` stands in an observation."""
    start = 0
    for entry in entries:
        if entry.name == name:
            return slice(start, start + entry.size)
        start += entry.size
    raise KeyError(name)


def observe(entries: tuple[Entry, ...], situation: Situation) -> Tensor:
    """The entries side by side, (N, size), without noise."""
    return torch.cat([entry.read(situation) for entry in entries], dim=1)


def noise_width(entries: tuple[Entry, ...], config: NoiseConfig) -> Tensor:
    """Half-width of the uniform sensor noise on every number of the observation, (size,)."""
    width = [0.0 if entry.noise is None else float(getattr(config, entry.noise)) for entry in entries]
    return torch.cat([torch.full((entry.size,), w) for entry, w in zip(entries, width, strict=True)])


def table(entries: tuple[Entry, ...], noise: NoiseConfig | None = None) -> str:
    """The entries as a Markdown table: index range, entry, size, unit, frame, scale and noise."""
    rows = [
        "| index | entry | size | unit | frame | scale | noise (uniform ±) |",
        "|---|---|---|---|---|---|---|",
    ]
    start = 0
    for entry in entries:
        width = getattr(noise, entry.noise) if noise is not None and entry.noise is not None else "-"
        index = f"{start}..{start + entry.size - 1}"
        rows.append(f"| {index} | `{entry.name}` | {entry.size} | {entry.unit} | {entry.frame} | 1 | {width} |")
        start += entry.size
    return "\n".join(rows)
