"""The control loop of an exported policy: onnxruntime and the policy's own metadata, whatever the robot is.

`observe` makes the observation from the robot's readings, `control` is the loop. Neither needs torch.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from camp.common.errors import CampError
from camp.common.onnx_session import open_session
from camp.deployment.metadata import read_metadata

Array = NDArray[np.float32]


class Policy:
    """policy.onnx: observation in, joint targets out, and the metadata that tells how to speak to it."""

    def __init__(self, path: Path):
        """Raises CampError where the file or onnxruntime is missing, or the file is no exported policy."""
        missing = "not found; write it with `python -m camp.export run=<run folder>`"
        self._session = open_session(path, missing)
        properties = self._session.get_modelmeta().custom_metadata_map
        if "joint_names" not in properties:
            raise CampError(f"policy {path}: holds no metadata of camp.export; export it again")
        try:
            self.metadata: dict[str, Any] = read_metadata(properties)
        except CampError as error:
            raise CampError(f"policy {path}: {error}") from error
        shapes = [(one.name, one.shape[-1:]) for one in (*self._session.get_inputs(), *self._session.get_outputs())]
        observed = self.metadata["history"] * sum(entry["size"] for entry in self.metadata["observation"])
        expected = [("obs", [observed]), ("joint_target", [len(self.metadata["joint_names"])])]
        if shapes != expected:
            raise CampError(f"policy {path}: maps {shapes}, its metadata say {expected}; export it again")

    def one_hot(self, skill: str) -> Array:
        """The observation's `skill` entry, (K,). Raises CampError for a skill that the policy does not know."""
        known = self.metadata["skills"]
        if skill not in known:
            raise CampError(f"skill {skill!r}: unknown to this policy; choose one of {', '.join(known)}")
        return np.array([name == skill and self.metadata["observe_skill"] for name in known], np.float32)

    def within_range(self, command: Sequence[float]) -> list[float]:
        """vx, vy in m/s, yaw rate in rad/s, clipped to the range of training; as it is where the policy names none."""
        ranges = self.metadata.get("command_range")
        if ranges is None:
            return list(command)
        return [min(max(value, low), high) for value, (low, high) in zip(command, ranges.values(), strict=True)]

    def remembered(self, frames: Sequence[Array], frame: Array) -> list[Array]:
        """The control steps that the policy sees, the oldest first, after one more. The first one stands for those
        before it."""
        history = self.metadata["history"]
        return [*(frames or [frame] * history), frame][-history:]

    def joint_target(self, observation: Array) -> Array:
        """(H (45 + K),) of H control steps -> (12,) rad. Raises CampError for an answer that is no number."""
        (answer,) = self._session.run(None, {"obs": observation[None]})
        target = np.asarray(answer, dtype=np.float32)[0]
        if not np.isfinite(target).all():
            joint = self.metadata["joint_names"][int(np.argmin(np.isfinite(target)))]
            raise CampError(f"the policy's target for {joint} is not finite: its weights are damaged; export it again")
        return target


class Readings(Protocol):
    """What is observed of a robot; joints in the order of the metadata's ``joint_names``."""

    @property
    def joint_position(self) -> Array:
        """(12,) rad."""
        ...

    @property
    def joint_velocity(self) -> Array:
        """(12,) rad/s."""
        ...

    @property
    def angular_velocity(self) -> Array:
        """(3,) rad/s, base frame: the gyroscope."""
        ...

    @property
    def gravity(self) -> Array:
        """(3,) unit vector of gravity, base frame."""
        ...


class Body(Readings, Protocol):
    """A robot that the loop reads and tells what to do."""

    def hold(self, target: Array) -> None:
        """Hold joint targets (12,) in rad for one control period."""
        ...


def observe(policy: Policy, body: Readings, command: Array, skill: Array, last_action: Array) -> Array:
    """One control step of the policy's observation, (45 + K,): raw readings in SI units, in the order that the metadata
    names."""
    entries = {
        "base_angular_velocity": body.angular_velocity,
        "gravity": body.gravity,
        "command": command,
        "joint_position": body.joint_position - np.array(policy.metadata["default_pose"], np.float32),
        "joint_velocity": body.joint_velocity,
        "last_action": last_action,
        "skill": skill,
    }
    return np.concatenate([entries[entry["name"]] for entry in policy.metadata["observation"]], dtype=np.float32)


class Memory:
    """What the loop keeps of a policy from one control step to the next: the last action and what it has observed."""

    def __init__(self, policy: Policy):
        self._policy = policy
        self._pose = np.array(policy.metadata["default_pose"], np.float32)
        self._scale = np.float32(policy.metadata["action_scale"])
        self.clear()

    def clear(self) -> None:
        """Forget both: the robot stands in the default pose."""
        self._last_action = np.zeros_like(self._pose)
        self._frames: list[Array] = []

    def target(self, body: Readings, skill: str, command: Sequence[float]) -> Array:
        """The next joint target, (12,) rad.

        command: vx, vy in m/s, yaw rate in rad/s. Raises CampError for a skill that the policy does not know, and for
        an answer that is not finite.
        """
        wanted, one_hot = np.array(command, np.float32), self._policy.one_hot(skill)
        frame = observe(self._policy, body, wanted, one_hot, self._last_action)
        self._frames = self._policy.remembered(self._frames, frame)
        target = self._policy.joint_target(np.concatenate(self._frames))
        self._last_action = (target - self._pose) / self._scale
        return target


def control(policy: Policy, body: Body, skill: str, command: Sequence[float]) -> Iterator[Array]:
    """The control loop, without an end: each joint target (12,) in rad, after the robot has held it.

    command: vx, vy in m/s, yaw rate in rad/s. Raises CampError as `Memory.target` does.
    """
    memory = Memory(policy)
    while True:
        target = memory.target(body, skill, command)
        body.hold(target)
        yield target
