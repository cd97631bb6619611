"""What policy and critic observe: named entries, of which the configuration lists those that each gets.

All entries are in SI units without scaling: the networks' running normalizers scale them, so that an exported policy
takes what sensors give. The paper's policy sees 45 + K numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from camp.common.errors import ConfigError
from camp.common.markdown import pipe_table
from camp.common.tensors import constant
from camp.envs.config import NoiseConfig, ObservationConfig
from camp.envs.situation import Situation
from camp.robots.mirror import FEET, JOINT_PROPERTIES, JOINTS, LINKS, ROTATION, SCALAR, TWIST, VECTOR, Mirror
from camp.robots.quadruped import NUM_JOINTS, NUM_LEGS
from camp.sim.base import LINK_NAMES

PER_SKILL = 0  # the size of an entry with one number for each skill


@dataclass(frozen=True)
class Entry:
    """One row of an observation table."""

    name: str
    size: int
    unit: str
    frame: str
    read: Callable[[Situation], Tensor]
    noise: str | None = None  # the field of NoiseConfig that holds its half-width
    mirror: Mirror | None = None  # how it looks in a mirror, where that is known

    def known_mirror(self) -> Mirror:
        """How it looks in a mirror. Raises ConfigError where that is not known."""
        if self.mirror is None:
            raise ConfigError(
                f"observation entry {self.name!r} beside algo.ppo.symmetry_weight > 0: its mirror image is not known; "
                "give its @observation_entry a mirror (camp.robots.mirror), or set algo.ppo.symmetry_weight to 0"
            )
        return self.mirror


ENTRIES: dict[str, Entry] = {}


def observation_entry(
    size: int, unit: str, frame: str, noise: str | None = None, mirror: Mirror | None = None
) -> Callable[[Callable[[Situation], Tensor]], Callable[[Situation], Tensor]]:
    """Make a function ``situation -> (N, size)`` known as an observation entry under its own name.

    noise: the field of conf/env's ``noise`` with the half-width of its sensor noise, where it has any. mirror: its
    numbers seen in a mirror, which `algo.ppo.symmetry_weight` needs.
    """

    def register(read: Callable[[Situation], Tensor]) -> Callable[[Situation], Tensor]:
        name = getattr(read, "__name__", "")
        if name in ENTRIES:
            raise ValueError(f"observation entry {name!r}: this name is taken; choose another one")
        ENTRIES[name] = Entry(name, size, unit, frame, read, noise, mirror)
        return read

    return register


@observation_entry(3, "rad/s", "base", "angular_velocity_rad_s", mirror=ROTATION)
def base_angular_velocity(s: Situation) -> Tensor:
    return s.measurement.angular_velocity


@observation_entry(3, "1", "base", "gravity", mirror=VECTOR)
def gravity(s: Situation) -> Tensor:
    return s.measurement.gravity


@observation_entry(3, "m/s, m/s, rad/s", "base", mirror=TWIST)
def command(s: Situation) -> Tensor:
    return s.command


@observation_entry(NUM_JOINTS, "rad", "joint, from the default pose", "joint_position_rad", mirror=JOINTS)
def joint_position(s: Situation) -> Tensor:
    return s.measurement.joint_position - constant(s.setup.robot.default_joint_position, s.command)


@observation_entry(NUM_JOINTS, "rad/s", "joint", "joint_velocity_rad_s", mirror=JOINTS)
def joint_velocity(s: Situation) -> Tensor:
    return s.measurement.joint_velocity


@observation_entry(NUM_JOINTS, "1", "joint, in action scales", mirror=JOINTS)
def last_action(s: Situation) -> Tensor:
    return s.last_action


@observation_entry(PER_SKILL, "1", "one-hot")
def skill(s: Situation) -> Tensor:
    return s.skill_one_hot * s.setup.observe_skill


@observation_entry(3, "m/s", "base", mirror=VECTOR)
def base_linear_velocity(s: Situation) -> Tensor:
    return s.measurement.linear_velocity


@observation_entry(1, "m", "world", mirror=SCALAR)
def base_height(s: Situation) -> Tensor:
    return s.measurement.base_position[:, 2:]


@observation_entry(NUM_LEGS, "0 or 1", "-", mirror=FEET)
def foot_contact(s: Situation) -> Tensor:
    return s.foot_contact


@observation_entry(3, "m/s, m/s, rad/s", "base", mirror=TWIST)
def average_velocity(s: Situation) -> Tensor:
    """As it is rewarded."""
    return s.average_velocity


@observation_entry(len(LINK_NAMES), "1", "-", mirror=LINKS)
def link_mass_scale(s: Situation) -> Tensor:
    return s.dynamics.link_mass_scale


@observation_entry(1, "kg", "-", mirror=SCALAR)
def payload_mass(s: Situation) -> Tensor:
    return s.dynamics.payload_mass[:, None]


@observation_entry(3, "m", "base", mirror=VECTOR)
def payload_position(s: Situation) -> Tensor:
    return s.dynamics.payload_position


@observation_entry(1, "1", "-", mirror=SCALAR)
def friction(s: Situation) -> Tensor:
    return s.dynamics.friction[:, None]


@observation_entry(NUM_JOINTS, "1", "joint", mirror=JOINT_PROPERTIES)
def motor_strength(s: Situation) -> Tensor:
    return s.dynamics.motor_strength


@observation_entry(NUM_JOINTS, "1", "joint", mirror=JOINT_PROPERTIES)
def kp_scale(s: Situation) -> Tensor:
    return s.dynamics.kp_scale


@observation_entry(NUM_JOINTS, "1", "joint", mirror=JOINT_PROPERTIES)
def kd_scale(s: Situation) -> Tensor:
    return s.dynamics.kd_scale


@observation_entry(1, "s", "-", mirror=SCALAR)
def delay(s: Situation) -> Tensor:
    """By which joint targets reach the motors late."""
    return s.dynamics.delay[:, None]


def check_names(key: str, names: Sequence[str]) -> None:
    """Raise ConfigError where ``key``, a list of entries, names none, one that is not known, or one twice."""
    unknown = [name for name in names if name not in ENTRIES]
    if unknown:
        raise ConfigError(f"{key}: no such entry {unknown[0]!r}; choose from {', '.join(ENTRIES)}")
    if not names or len(set(names)) < len(names):
        raise ConfigError(f"{key} = {list(names)}: name one entry or more, each once")


def entries_of(names: Sequence[str], num_skills: int) -> tuple[Entry, ...]:
    """The entries of these names, in this order, for K skills."""
    found = (ENTRIES[name] for name in names)
    unchanged = Mirror.signs(*[1.0] * num_skills)  # a gait and its mirror image are one skill
    return tuple(
        replace(entry, size=num_skills, mirror=unchanged) if entry.size == PER_SKILL else entry for entry in found
    )


def size(entries: tuple[Entry, ...]) -> int:
    """Numbers in an observation."""
    return sum(entry.size for entry in entries)


def sizes(config: ObservationConfig, num_skills: int) -> tuple[int, int]:
    """How many numbers the policy observes, and how many the critic besides."""
    frame = size(entries_of(config.policy, num_skills))
    return config.history * frame, size(entries_of(config.critic, num_skills))


def position(entries: tuple[Entry, ...], name: str) -> slice:
    """Where the entry ``name`` stands in an observation; an empty slice where it does not."""
    start = 0
    for entry in entries:
        if entry.name == name:
            return slice(start, start + entry.size)
        start += entry.size
    return slice(0, 0)


def observe(entries: tuple[Entry, ...], situation: Situation) -> Tensor:
    """The entries side by side, (N, size), without noise."""
    return torch.cat([entry.read(situation) for entry in entries], dim=1)


def noise_width(entries: tuple[Entry, ...], config: NoiseConfig) -> Tensor:
    """Half-width of the uniform sensor noise on every number of the observation, (size,)."""
    width = [0.0 if entry.noise is None else float(getattr(config, entry.noise)) for entry in entries]
    return torch.cat([torch.full((entry.size,), w) for entry, w in zip(entries, width, strict=True)])


def table(entries: tuple[Entry, ...], noise: NoiseConfig | None = None) -> str:
    """The entries as a Markdown table: index range, entry, size, unit, frame, scale and noise."""
    rows, start = [], 0
    for entry in entries:
        width = getattr(noise, entry.noise) if noise is not None and entry.noise is not None else "-"
        index = f"{start}..{start + entry.size - 1}"
        rows.append([index, f"`{entry.name}`", str(entry.size), entry.unit, entry.frame, "1", str(width)])
        start += entry.size
    return pipe_table(["index", "entry", "size", "unit", "frame", "scale", "noise (uniform ±)"], rows)
