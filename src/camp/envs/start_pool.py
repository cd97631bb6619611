"""The starts that robots take when their episodes end."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs.commands import sample_skills
from camp.envs.config import EnvConfig
from camp.envs.measurement import measure
from camp.envs.observer import Observed, Observer
from camp.envs.randomization import randomization_at, sample_dynamics
from camp.envs.situation import Before, Setup, Situation
from camp.envs.skill_schedule import SkillSchedule
from camp.envs.starts import Moment, Starts, draw_starts
from camp.motion.clips.sampler import ReferenceStates
from camp.sim.base import Dynamics


class StartPool:
    """One start for each of N robots, for whose episode ends before the next draw, and what is observed in it.

    Args:
        setup: what is the same for all robots.
        config: conf/env.
        references: frames of expert clips.
        observer: of the environment.
        generator: of the environment.
    """

    starts: Starts
    observed: Observed
    action: Tensor  # (N, 12) the network's output that asks for the joint targets held before the start

    def __init__(
        self,
        setup: Setup,
        config: EnvConfig,
        references: ReferenceStates,
        observer: Observer,
        generator: torch.Generator,
    ):
        self._setup, self._config, self._references = setup, config, references
        self._observer, self._generator = observer, generator

    def drawn(
        self,
        num: int,
        difficulty: float,
        schedule: SkillSchedule | None,
        dynamics: Dynamics | None = None,
        skill: Tensor | None = None,
    ) -> Starts:
        """New starts of N robots; dynamics: theirs, or else random ones as hard as ``difficulty`` says; skill: their
        labels (N,), or else drawn."""
        if dynamics is None:
            ranges = randomization_at(difficulty, self._config.randomization)
            dynamics = sample_dynamics(num, ranges, self._generator)
        if skill is None:
            skill = sample_skills(num, self._references.num_skills, self._generator, schedule)
        return draw_starts(self._setup.robot, dynamics, skill, self._config, self._references, self._generator)

    def keep(self, starts: Starts, noise: float) -> None:
        """Have these ready, and what is observed in them with this share of the sensor noise."""
        self._take(starts)
        now = Moment(starts.initial, starts.joint_target)
        seen = [self._observer.frame(self._situation(moment), noise) for moment in (*starts.earlier, now)]
        observation = self._observer.first([one.observation for one in seen])
        self.observed = Observed(observation, seen[-1].privileged)

    def _situation(self, moment: Moment) -> Situation:
        """At the start or before it; whatever does not belong to the moment is the start's."""
        starts = self.starts
        measurement = measure(self._setup.robot, moment.initial.robot_state())
        action = self._action(moment.joint_target)
        return Situation(
            self._setup,
            measurement,
            starts.command,
            starts.skill,
            action,
            starts.average_velocity,
            starts.dynamics,
            Before(action, measurement.joint_velocity),
        )

    def state_dict(self) -> dict[str, Any]:
        return {"starts": self.starts.state_dict(), "starts_observed": vars(self.observed)}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._take(Starts.from_state_dict(state["starts"]))
        self.observed = Observed(**state["starts_observed"])

    def _take(self, starts: Starts) -> None:
        self.starts = starts
        self.action = self._action(starts.joint_target)

    def _action(self, joint_target: Tensor) -> Tensor:
        """(N, 12) the network's output that asks for these targets."""
        pose = constant(self._setup.robot.default_joint_position, joint_target)
        return (joint_target - pose) / self._setup.action_scale
