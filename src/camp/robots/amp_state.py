"""The state that the discriminators judge (paper, Sec. III-C): which entries it has, in which order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, TypeVar

from camp.robots.quadruped import NUM_JOINTS, NUM_LEGS

Array = TypeVar("Array")  # of numpy or torch


class AmpEntry(NamedTuple):
    """One row of the layout."""

    name: str
    size: int
    unit: str
    frame: str


AMP_ENTRIES = (
    AmpEntry("joint_position", NUM_JOINTS, "rad", "joint"),
    AmpEntry("joint_velocity", NUM_JOINTS, "rad/s", "joint"),
    AmpEntry("base_linear_velocity", 3, "m/s", "base"),
    AmpEntry("base_angular_velocity", 3, "rad/s", "base"),
    AmpEntry("base_height", 1, "m", "world"),
    AmpEntry("foot_position", 3 * NUM_LEGS, "m", "base"),
)
AMP_STATE_SIZE = sum(entry.size for entry in AMP_ENTRIES)  # 43
# Not of the paper; behind the others with `env.foot_stance`.
FOOT_STANCE = AmpEntry("foot_stance", NUM_LEGS, "fraction of the control step", "-")


def discriminator_state_size(foot_stance: bool) -> int:
    """S, how many numbers the discriminators see of one moment: 43, or 47 with ``foot_stance``."""
    return AMP_STATE_SIZE + (FOOT_STANCE.size if foot_stance else 0)


def amp_parts(values: Mapping[str, Array]) -> list[Array]:
    """The entries (..., size), given by name, in the order of the layout: to be concatenated along the last axis.

    Raises KeyError for one that is missing.
    """
    return [values[entry.name] for entry in AMP_ENTRIES]


def amp_slice(name: str) -> slice:
    """Where the entry ``name`` stands in the state. Raises KeyError."""
    start = 0
    for entry in AMP_ENTRIES:
        if entry.name == name:
            return slice(start, start + entry.size)
        start += entry.size
    raise KeyError(name)
