"""Who is asked for what: the robots of one roll-out, with the commands, skills and troubles of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
import torch
from torch import Tensor

from camp.evaluation.conditions import Condition
from camp.gaits.skills import Skill
from camp.sim.base import Dynamics

Command = Sequence[float]  # vx, vy in m/s, yaw rate in rad/s


@dataclass
class Plan:
    """R robots over T control steps."""

    skill: Tensor  # (R, T) int64 label
    command: Tensor  # (R, 3) vx, vy in m/s, yaw rate in rad/s
    dynamics: Dynamics  # of each robot
    noise: Tensor  # (R,) times the sensor noise of the run's conf/env
    push_m_s: Tensor  # (R,) size of each push, in a random horizontal direction
    push_period_s: float = 1.0

    def __len__(self) -> int:
        return len(self.command)


def undisturbed(skill: Tensor, command: Tensor, friction: float) -> Plan:
    """Nominal robots: labels (R, T) and commands (R, 3)."""
    num = len(command)
    nominal = Dynamics.nominal(num, friction, torch.device("cpu"))
    return Plan(skill, command, nominal, torch.zeros(num), torch.zeros(num))


def grid_plan(num_skills: int, commands: Sequence[Command], steps: int, friction: float) -> Plan:
    """Every skill (K) at every command (G) throughout, skill by skill: R = K G."""
    skill = torch.arange(num_skills).repeat_interleave(len(commands))
    return undisturbed(
        skill[:, None].repeat(1, steps), torch.tensor(commands, dtype=torch.float32).repeat(num_skills, 1), friction
    )


def switching_plan(labels: Sequence[Sequence[int]], commands: Sequence[Command], steps: int, friction: float) -> Plan:
    """Every sequence of labels (W) at every command (G), sequence by sequence: R = W G, ``steps`` for each label."""
    skill = torch.tensor(labels).repeat_interleave(steps, dim=1).repeat_interleave(len(commands), dim=0)
    return undisturbed(skill, torch.tensor(commands, dtype=torch.float32).repeat(len(labels), 1), friction)


def disturbed_plan(grid: Plan, conditions: Sequence[Condition], friction: float, push_period_s: float) -> Plan:
    """The robots of a grid once under each condition (C), condition by condition: R = C K G."""
    num = len(grid)
    parts = [condition.dynamics(num, friction) for condition in conditions]
    dynamics = Dynamics(**{name: torch.cat([part.tensors()[name] for part in parts]) for name in parts[0].tensors()})
    return Plan(
        skill=grid.skill.repeat(len(conditions), 1),
        command=grid.command.repeat(len(conditions), 1),
        dynamics=dynamics,
        noise=torch.tensor([c.noise for c in conditions]).repeat_interleave(num),
        push_m_s=torch.tensor([c.push_m_s for c in conditions]).repeat_interleave(num),
        push_period_s=push_period_s,
    )


def one_per_gait(skills: Sequence[Skill]) -> list[int]:
    """The first label of each gait, in label order."""
    gaits = list(dict.fromkeys(skill.gait for skill in skills))
    return [next(k for k, skill in enumerate(skills) if skill.gait == gait) for gait in gaits]


def orders(labels: Sequence[int], most: int) -> list[tuple[int, ...]]:
    """The orders of ``labels``, at most ``most`` evenly spread ones; the first is that of ``labels`` itself."""
    every = list(permutations(labels))
    chosen = np.unique(np.linspace(0, len(every) - 1, min(most, len(every))).round().astype(int))
    return [every[index] for index in chosen]
