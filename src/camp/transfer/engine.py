"""What the loop needs of a physics engine, and the engines by name.

Every engine has a file of its own, which is imported where it is asked for: nobody needs to install them all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from camp.common.errors import CampError, ConfigError
from camp.robots.quadruped import CONTACT_FORCE, NUM_LEGS
from camp.transfer.description import Description

Floats = NDArray[np.floating]

READING_S = 0.005  # between two readings of the contacts, as in the judge's own simulation
STOPPING_RAD_S = 0.1  # speed at which dry friction is three quarters of its full size


@dataclass(frozen=True)
class State:
    """Where a robot is. World: x, y on the ground, z up; joint values in the order of JOINT_NAMES."""

    position: Floats  # (3,) m, origin of the base
    rotation: Floats  # (3, 3) base frame to world
    angular_velocity: Floats  # (3,) rad/s, of the base, world frame
    joint_position: Floats  # (12,) rad
    joint_velocity: Floats  # (12,) rad/s


@dataclass(frozen=True)
class Contacts:
    """What presses on the ground with more than 1 N."""

    feet: NDArray[np.bool_]  # (4,) in the order of FOOT_NAMES
    fallen: bool  # the base or a thigh


class Engine(Protocol):
    """One robot on flat ground in one physics engine."""

    timestep_s: float  # the engine's own; READING_S is a multiple of it

    def reset(self) -> None:
        """Stand in the default pose, at rest, the lowest foot just touching, and hold the pose."""
        ...

    def set_targets(self, target: Floats) -> None:
        """Hold these joint positions (12,), rad, from now on: the motors' PD law, clipped at the torque limits."""
        ...

    def step(self) -> None:
        """Let READING_S pass."""
        ...

    def state(self) -> State:
        """Where the robot is now."""
        ...

    def contacts(self) -> Contacts:
        """What touched the ground in the latest timestep."""
        ...


@dataclass(frozen=True)
class Kind:
    """How to find an engine. title: as texts name it."""

    title: str
    module: str
    package: str  # that pip knows; its version stands in the results


ENGINES = {
    "mujoco": Kind("MuJoCo", "camp.transfer.mujoco_engine", "mujoco"),
    "sapien": Kind("SAPIEN (PhysX)", "camp.transfer.sapien_engine", "sapien"),
    "dart": Kind("DART, Gazebo's default engine", "camp.transfer.dart_engine", "dartpy"),
    "drake": Kind("Drake", "camp.transfer.drake_engine", "drake"),
}


def find_engine(name: str) -> Kind:
    """The engine of that name. Raises ConfigError where there is none."""
    if name not in ENGINES:
        raise ConfigError(f"engine = {name!r}: unknown engine; choose one of {', '.join(ENGINES)}, all")
    return ENGINES[name]


def start_engine(name: str, description: Description) -> Engine:
    """The robot in the engine of that name. Raises CampError where the engine is unknown or not installed."""
    kind = find_engine(name)
    try:
        engine: Engine = import_module(kind.module).start(description)
    except ImportError as error:
        raise CampError(
            f"package {kind.package}: not installed ({error}); install camp's extra `sim2sim`: "
            "pip install -e '.[sim2sim]' -c constraints.txt"
        ) from error
    engine.reset()
    return engine


def engine_version(name: str) -> str:
    """Version of the engine's package."""
    return version(find_engine(name).package)


def contacts_of(force: Mapping[str, Floats], description: Description) -> Contacts:
    """Contacts from the sum of the ground's forces (3,), N, on each foot's shape and on each link of a fall."""
    size = {name: float(np.linalg.norm(value)) for name, value in force.items()}
    feet = np.zeros(NUM_LEGS, dtype=bool)
    for leg, foot in enumerate(description.feet):
        feet[leg] = size.get(foot, 0.0) > CONTACT_FORCE
    return Contacts(feet, any(size.get(link, 0.0) > CONTACT_FORCE for link in description.trunk_and_thighs))


def dry_friction(description: Description, joint_velocity: Floats) -> Floats:
    """Torque (12,), N m, of the joints' dry friction, for engines that have none: smooth where a joint stops."""
    return -description.dry_friction * np.tanh(joint_velocity / STOPPING_RAD_S)
