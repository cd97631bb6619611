"""What walks: networks behind a contract, and two that only seem to. One batch may hold several."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs.measurement import Measurement
from camp.evaluation.contract import Contract, Numbers
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import Skill
from camp.robots.quadruped import JOINT_NAMES, NUM_JOINTS
from camp.robots.registry import find_robot
from camp.robots.robot import Robot

Answer = Callable[[Tensor], Tensor]  # observation (N, O) -> the network's answer (N, 12)
SINE_AMPLITUDE_RAD = 0.15  # of the open-loop baseline


@dataclass
class Sight:
    """What N robots sense and are asked for at one control step."""

    measurement: Measurement  # with sensor noise where the plan says so
    command: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s
    skill: Tensor  # (N,) int64 label
    time_s: float  # since the start


class Controller(Protocol):
    """Joint targets for N robots, step by step."""

    def start(self, joint_target: Tensor) -> None:
        """Forget what was; joint_target: (N, 12) rad, what the PD law held before."""
        ...

    def __call__(self, sight: Sight) -> Tensor:
        """(N, 12) rad in the robot's joint order."""
        ...


class NetworkController:
    """A network as its contract says.

    Args:
        contract: of the network.
        answer: the network.
    """

    def __init__(self, contract: Contract, answer: Answer):
        self.contract, self._answer = contract, answer
        self._order = torch.tensor([JOINT_NAMES.index(name) for name in contract.joint_names])
        self._pose = torch.tensor(contract.default_pose)
        self._scale, self._offset = _tensor(contract.output.scale), _tensor(contract.output.offset)
        self._encoding = torch.tensor(list(contract.skills.values()), dtype=torch.float32)
        self._frequency = torch.tensor([skill.frequency_hz or 0.0 for skill in contract.skill_set])

    def start(self, joint_target: Tensor) -> None:
        target = joint_target[:, self._order]
        self._last = torch.where(self._scale != 0, (target - self._offset) / self._scale, 0.0)
        self._frames: list[list[Tensor]] = []

    def __call__(self, sight: Sight) -> Tensor:
        answer = self._answer(self._observation(sight))
        if self.contract.output.clip is not None:
            answer = answer.clamp(*self.contract.output.clip)
        self._last = answer
        target = torch.empty_like(answer)
        target[:, self._order] = self._offset + self._scale * answer
        return target

    def _observation(self, sight: Sight) -> Tensor:
        frame = [self._entry(term.term, sight) for term in self.contract.observation]
        for i, term in enumerate(self.contract.observation):
            value = (frame[i] - _tensor(term.offset)) * _tensor(term.scale)
            frame[i] = value.clamp(*term.clip) if term.clip is not None else value
        history = self.contract.history
        self._frames = [*(self._frames or [frame] * history), frame][-history:]
        frames = self._frames if self.contract.history_order == "oldest_first" else self._frames[::-1]
        if self.contract.history_layout == "terms":
            return torch.cat([one for term in zip(*frames, strict=True) for one in term], dim=1)
        return torch.cat([one for frame in frames for one in frame], dim=1)

    def _entry(self, name: str, sight: Sight) -> Tensor:
        seen = sight.measurement
        if name == "joint_position":
            return seen.joint_position[:, self._order] - self._pose
        if name == "joint_velocity":
            return seen.joint_velocity[:, self._order]
        if name == "last_action":
            return self._last
        if name == "skill":
            return self._encoding[sight.skill]
        if name == "phase":
            angle = 2 * math.pi * sight.time_s * self._frequency[sight.skill]
            return torch.stack([torch.sin(angle), torch.cos(angle)], dim=1)
        if name == "time":
            return torch.full((len(sight.skill), 1), sight.time_s)
        return {
            "base_angular_velocity": seen.angular_velocity,
            "base_linear_velocity": seen.linear_velocity,
            "gravity": seen.gravity,
            "command": sight.command,
        }[name]


class Standing:
    """Holds the robot's default pose: what a figure has to beat."""

    def __init__(self, robot: Robot):
        self._default = robot.default_joint_position

    def start(self, joint_target: Tensor) -> None:
        self._pose = constant(self._default, joint_target).expand_as(joint_target)

    def __call__(self, sight: Sight) -> Tensor:
        return self._pose


class OpenLoopSine:
    """Sines about the default pose at the commanded gait's phases and frequency, blind to the robot.

    It gives the contacts a rhythm without walking: the hind feet hardly leave the ground.

    Args:
        robot: whose default pose it is.
        skills: in label order.
        amplitude_rad: of the thighs; the calves move twice as far.
    """

    def __init__(self, robot: Robot, skills: Sequence[Skill], amplitude_rad: float = SINE_AMPLITUDE_RAD):
        self._default, self._amplitude = robot.default_joint_position, amplitude_rad
        self._phase = torch.tensor([GAIT_PHASES[skill.gait] for skill in skills])  # (K, 4)
        self._frequency = torch.tensor([skill.frequency_hz or 2.0 for skill in skills])

    def start(self, joint_target: Tensor) -> None:
        self._pose = constant(self._default, joint_target)

    def __call__(self, sight: Sight) -> Tensor:
        cycles = sight.time_s * self._frequency[sight.skill][:, None] - self._phase[sight.skill]
        wave = self._amplitude * torch.sin(2 * math.pi * cycles)  # (N, 4)
        offset = torch.stack([torch.zeros_like(wave), wave, -2.0 * wave], dim=-1)
        return self._pose + offset.reshape(-1, NUM_JOINTS)


def robot_of(contract: Contract) -> Robot:
    """The contract's robot with the contract's gains."""
    order = [contract.joint_names.index(name) for name in JOINT_NAMES]
    kp, kd = (tuple(gain[i] for i in order) for gain in (contract.kp, contract.kd))
    return replace(find_robot(contract.robot, "robot"), pd_gain_p=kp, pd_gain_d=kd)


def _tensor(value: Numbers) -> Tensor:
    return torch.tensor(value, dtype=torch.float32)
