"""What is drawn at random: commands, starts, and the order of switches. Everything from the suite's seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs import initialization
from camp.envs.commands import uniform
from camp.envs.config import InitializationConfig
from camp.evaluation.config import CommandsConfig, WalksConfig
from camp.evaluation.contract import CommandRange
from camp.gaits.skills import Skill
from camp.motion.clips.sampler import ReferenceStates
from camp.robots.robot import Robot
from camp.sim.base import InitialState, select


@dataclass
class Starts:
    """Where n robots start."""

    initial: InitialState
    joint_target: Tensor  # (n, 12) rad, what the PD law held before

    def tensors(self) -> dict[str, Tensor]:
        """Name to tensor, without copies."""
        return vars(self.initial) | {"joint_target": self.joint_target}

    @classmethod
    def joined(cls, parts: Sequence[Starts]) -> Starts:
        """All starts one after the other."""
        tensors = {name: torch.cat([part.tensors()[name] for part in parts]) for name in parts[0].tensors()}
        target = tensors.pop("joint_target")
        return cls(InitialState(**tensors), target)


def random_commands(num: int, config: CommandsConfig, allowed: CommandRange | None, stream: torch.Generator) -> Tensor:
    """(num, 3) commands vx, vy in m/s and yaw rate in rad/s.

    allowed: what the policy was trained for; values beyond are brought to its ends.
    """
    ranges = (config.vx_m_s, config.vy_m_s, config.yaw_rate_rad_s)
    command = torch.stack([uniform(interval, (num,), stream) for interval in ranges], dim=1)
    keep = torch.rand(num, 3, generator=stream) >= config.zero_component_fraction
    moving = torch.rand(num, 1, generator=stream) >= config.zero_fraction
    return clipped(command * keep * moving, allowed)


def clipped(command: Tensor, allowed: CommandRange | None) -> Tensor:
    """Commands (n, 3) within the policy's own range."""
    if allowed is None:
        return command
    low, high = torch.tensor([allowed.vx_m_s, allowed.vy_m_s, allowed.yaw_rate_rad_s]).T
    return torch.minimum(torch.maximum(command, low), high)


def standing_starts(robot: Robot, num: int, scale: Sequence[float], stream: torch.Generator) -> Starts:
    """Robots at rest whose joint angles are the default pose's times uniform draws from ``scale``."""
    config = InitializationConfig(reference_fraction=0.0, joint_position_scale=list(scale))
    initial = initialization.standing(robot, num, config, stream)
    return Starts(initial, constant(robot.default_joint_position, initial.joint_position).expand(num, -1).clone())


def walk_starts(
    robot: Robot, label: Tensor, config: WalksConfig, references: ReferenceStates, stream: torch.Generator
) -> Starts:
    """A start for each of the labels (n,): a fraction standing, the rest in the midst of a stride of another gait.

    Where there is no other gait, of another frequency, or else of any.
    """
    num, skills = len(label), references.skills
    others = [_others(skill, skills) for skill in skills]
    draw = torch.rand(num, generator=stream)
    before = torch.tensor(
        [others[k][int(u * len(others[k]))] for k, u in zip(label.tolist(), draw.tolist(), strict=True)]
    )
    frame = references.sample(before, stream)
    moving = Starts(initialization.from_reference(frame), frame.joint_target_applied_previous)
    still = standing_starts(robot, num, config.standing_scale, stream)
    stands = torch.rand(num, generator=stream) < config.standing_fraction
    initial = moving.initial.replaced(stands, still.initial)
    return Starts(initial, select(stands, still.joint_target, moving.joint_target))


def _others(skill: Skill, skills: Sequence[Skill]) -> list[int]:
    of_gait = [k for k, other in enumerate(skills) if other.gait != skill.gait]
    return of_gait or [k for k, other in enumerate(skills) if other != skill] or list(range(len(skills)))


def switch_sequences(num_skills: int, length: int) -> list[list[int]]:
    """Sequences of ``length`` labels in which every switch from one skill to another happens exactly once.

    A closed walk that takes each of the K (K - 1) directed edges once (Euler; found by Hierholzer's method), cut into
    pieces that begin where the one before ends. The last piece may be shorter; it is filled with its last label, which
    is no switch.
    """
    if num_skills < 2:
        return [[0] * length]
    left = {k: [(k + step) % num_skills for step in range(num_skills - 1, 0, -1)] for k in range(num_skills)}
    path, circuit = [0], []
    while path:
        if left[path[-1]]:
            path.append(left[path[-1]].pop())
        else:
            circuit.append(path.pop())
    circuit.reverse()
    pieces = [circuit[start : start + length] for start in range(0, len(circuit) - 1, length - 1)]
    return [piece + [piece[-1]] * (length - len(piece)) for piece in pieces]
