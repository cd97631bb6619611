"""The metadata of an exported policy (docs/deployment.md): reading and checks."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from typing import Any

from camp.common.errors import CampError
from camp.common.foreign import first_line, read_json
from camp.robots.quadruped import JOINT_NAMES, NUM_JOINTS
from camp.robots.registry import DEFAULT_ROBOT, ROBOTS

LONGEST_PERIOD = 0.1  # s; a gait of 3 strides per second cannot be controlled, nor its contacts seen, more slowly
LONGEST_HISTORY = 100  # control steps that an observation holds
COMMANDS = ("vx_m_s", "vy_m_s", "yaw_rate_rad_s")
ENTRY_SIZES = {
    "base_angular_velocity": 3,
    "gravity": 3,
    "command": 3,
    "joint_position": NUM_JOINTS,
    "joint_velocity": NUM_JOINTS,
    "last_action": NUM_JOINTS,
}  # of the observation, besides `skill`, which has one number for each skill


def read_metadata(properties: Mapping[str, str]) -> dict[str, Any]:
    """A model's ``metadata_props``, each value as JSON, as plain values that fit the robot. Raises CampError.

    A policy that names no robot or no history is older than these keys.
    """
    metadata: dict[str, Any] = {"robot": DEFAULT_ROBOT, "history": 1}
    for key, text in properties.items():
        try:
            metadata[key] = read_json(text)
        except ValueError as error:
            raise _unusable(key, text, f"not JSON ({first_line(error)})") from error
    for key, (holds, expected) in _EXPECTED.items():
        if key not in metadata:
            raise CampError(f"metadata {key}: missing; export the policy again")
        if not holds(metadata[key]):
            raise _unusable(key, metadata[key], f"not {expected}")
    if "command_range" in metadata and not _ranges(metadata["command_range"]):  # older files may lack it
        raise _unusable("command_range", metadata["command_range"], f"not [low, high] of {', '.join(COMMANDS)}")
    sizes = ENTRY_SIZES | {"skill": len(metadata["skills"])}
    for entry in metadata["observation"]:
        name = entry.get("name") if isinstance(entry, dict) else None
        if not isinstance(name, str) or name not in sizes:
            raise CampError(
                f"metadata observation = {reprlib.repr(entry)}: none of what this loop reads from its robot "
                f"({', '.join(sizes)}); train with env.observation.policy of these, or read it in a loop of your own"
            )
        if entry.get("size") != sizes[name]:
            raise _unusable("observation", entry, f"its size is not {sizes[name]}")
    return metadata


def _unusable(key: str, value: Any, reason: str) -> CampError:
    return CampError(f"metadata {key} = {reprlib.repr(value)}: {reason}; export the policy again")


def _positive(value: Any) -> bool:
    return type(value) in (int, float) and 0.0 < value < math.inf


def _ranges(value: Any) -> bool:
    """Whether it is {name: [low, high]} of COMMANDS, in their order."""
    return (
        isinstance(value, dict)
        and tuple(value) == COMMANDS
        and all(isinstance(ends, list) and len(ends) == 2 and all(map(_finite, ends)) for ends in value.values())
        and all(low <= high for low, high in value.values())
    )


def _finite(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _of_every_joint(value: Any) -> bool:
    return isinstance(value, list) and len(value) == NUM_JOINTS and all(map(_finite, value))


def _texts(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(text, str) for text in value)


_EXPECTED = {
    "robot": (lambda v: isinstance(v, str) and v in ROBOTS, f"one of {', '.join(ROBOTS)}"),
    "joint_names": (lambda v: _texts(v) and sorted(v) == sorted(JOINT_NAMES), "the robot's 12 joints"),
    **dict.fromkeys(("default_pose", "kp", "kd"), (_of_every_joint, f"{NUM_JOINTS} finite numbers")),
    "action_scale": (_positive, "a finite number above 0"),
    "control_period": (lambda v: _positive(v) and v <= LONGEST_PERIOD, f"in (0, {LONGEST_PERIOD:g}] s"),
    "skills": (_texts, "a list of names"),
    "observation": (lambda v: isinstance(v, list), "a list of entries"),
    "history": (lambda v: type(v) is int and 1 <= v <= LONGEST_HISTORY, f"a number from 1 to {LONGEST_HISTORY}"),
    "observe_skill": (lambda v: isinstance(v, bool), "true or false"),
}
