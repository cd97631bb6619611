"""Who is asked for what: the robots of one batch, with the commands, skills, starts and disturbances of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from camp.common.seeding import generator
from camp.envs.randomization import sample_dynamics
from camp.evaluation.config import EvaluationConfig
from camp.evaluation.contract import CommandRange
from camp.evaluation.sampling import (
    Starts,
    clipped,
    random_commands,
    standing_starts,
    switch_sequences,
    walk_starts,
)
from camp.gaits.skills import Skill
from camp.motion.clips.sampler import ReferenceStates
from camp.robots.robot import Robot
from camp.sim.base import Dynamics

ONE_SIZE = (1.0, 1.0)


@dataclass
class Disturbances:
    """What befalls each of R robots; see `Condition`."""

    noise: Tensor  # (R,)
    push_m_s: Tensor  # (R,)
    loss: Tensor  # (R,)

    @classmethod
    def of(cls, num: int, noise: float = 0.0, push_m_s: float = 0.0, loss: float = 0.0):
        return cls(*(torch.full((num,), value) for value in (noise, push_m_s, loss)))


@dataclass
class Plan:
    """R robots over T control steps; ``name`` is that of their own streams of noise, pushes and losses."""

    name: str
    skill: Tensor  # (R, T) int64 label
    command: Tensor  # (R, 3) vx, vy in m/s, yaw rate in rad/s
    starts: Starts
    dynamics: Dynamics
    disturbances: Disturbances

    def __len__(self) -> int:
        return len(self.command)

    @property
    def steps(self) -> int:
        """T."""
        return self.skill.shape[1]


def joined(name: str, plans: Sequence[Plan]) -> Plan:
    """All robots in one plan; those of a shorter one go on with their last skill."""
    steps = max(plan.steps for plan in plans)
    skill = [torch.cat([p.skill, p.skill[:, -1:].expand(-1, steps - p.steps)], dim=1) for p in plans]
    dynamics = [plan.dynamics.tensors() for plan in plans]
    disturbances = [vars(plan.disturbances) for plan in plans]
    return Plan(
        name=name,
        skill=torch.cat(skill),
        command=torch.cat([plan.command for plan in plans]),
        starts=Starts.joined([plan.starts for plan in plans]),
        dynamics=Dynamics(**{name: torch.cat([part[name] for part in dynamics]) for name in dynamics[0]}),
        disturbances=Disturbances(
            **{name: torch.cat([part[name] for part in disturbances]) for name in disturbances[0]}
        ),
    )


@dataclass
class Planner:
    """Makes the plans of a suite for one policy's skills.

    allowed: commands that the policy was trained for; references: frames of the robot's expert clips by these skills.
    """

    evaluation: EvaluationConfig
    robot: Robot
    skills: tuple[Skill, ...]
    period_s: float
    allowed: CommandRange | None
    references: ReferenceStates

    @property
    def clips_commands(self) -> bool:
        """Whether the policy's own command range leaves out some of the suite's commands."""
        config = self.evaluation.random_commands
        ends = torch.tensor([list(config.vx_m_s), list(config.vy_m_s), list(config.yaw_rate_rad_s)]).T  # (2, 3)
        return not torch.equal(clipped(ends, self.allowed), ends)

    def grid(self) -> Plan:
        """Every skill at every command of ``commands``, from standing, skill by skill: R = K G."""
        commands = torch.tensor(self.evaluation.commands, dtype=torch.float32)
        label = torch.arange(len(self.skills)).repeat_interleave(len(commands))
        command = clipped(commands.repeat(len(self.skills), 1), self.allowed)
        starts = standing_starts(self.robot, len(label), ONE_SIZE, self._stream("grid"))
        return self._undisturbed("grid", label, command, starts)

    def walks(self, per_skill: int, stream: str) -> Plan:
        """``per_skill`` random walks of each skill, skill by skill; ``stream`` names the draw."""
        source = self._stream(stream)
        label = torch.arange(len(self.skills)).repeat_interleave(per_skill)
        command = random_commands(len(label), self.evaluation.random_commands, self.allowed, source)
        starts = walk_starts(self.robot, label, self.evaluation.walks, self.references, source)
        return self._undisturbed(stream, label, command, starts)

    def table_i(self) -> Plan:
        """Random walks of robots drawn from the whole of Table I, with sensor noise and pushes."""
        wanted = self.evaluation.table_i
        plan = self.walks(wanted.per_skill, "table_i")
        plan.dynamics = sample_dynamics(len(plan), self.evaluation.randomization, self._stream("dynamics"))
        plan.disturbances = Disturbances.of(len(plan), noise=1.0, push_m_s=wanted.push_m_s)
        return plan

    def robustness(self) -> Plan:
        """The same random walks under each condition, condition by condition."""
        plans = []
        for condition in self.evaluation.robustness.all():
            plan = self.walks(self.evaluation.robustness.per_skill, "robustness")
            plan.dynamics = condition.dynamics(len(plan), self.evaluation.randomization.nominal_friction)
            plan.disturbances = Disturbances.of(len(plan), condition.noise, condition.push_m_s, condition.loss)
            plans.append(plan)
        return joined("robustness", plans)

    def switching(self) -> Plan:
        """Every switch at each of some random commands, from standing; the first segment's end is the first switch."""
        wanted = self.evaluation.switching
        labels = torch.tensor(switch_sequences(len(self.skills), wanted.skills_per_sequence))  # (W, S)
        source = self._stream("switching")
        each = labels.repeat_interleave(wanted.commands_per_switch, dim=0)
        command = random_commands(len(each), self.evaluation.random_commands, self.allowed, source)
        starts = standing_starts(self.robot, len(each), self.evaluation.walks.standing_scale, source)
        skill = each.repeat_interleave(round(wanted.skill_s / self.period_s), dim=1)
        return self._plan("switching", skill, command, starts)

    def _undisturbed(self, name: str, label: Tensor, command: Tensor, starts: Starts) -> Plan:
        steps = round(self.evaluation.duration_s / self.period_s)
        return self._plan(name, label[:, None].repeat(1, steps), command, starts)

    def _plan(self, name: str, skill: Tensor, command: Tensor, starts: Starts) -> Plan:
        friction = self.evaluation.randomization.nominal_friction
        dynamics = Dynamics.nominal(len(command), friction, torch.device("cpu"))
        return Plan(name, skill, command, starts, dynamics, Disturbances.of(len(command)))

    def _stream(self, name: str) -> torch.Generator:
        return generator(self.evaluation.seed, f"evaluation/{name}")
