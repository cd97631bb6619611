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
from camp.envs.starts import Starts, draw_starts
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
        self, num: int, difficulty: float, schedule: SkillSchedule | None, dynamics: Dynamics | None = None
    ) -> Starts:
        """New starts of N robots; dynamics: theirs, or else random ones as hard as ``difficulty`` says."""
        if dynamics is None:
            ranges = randomization_at(difficulty, self._config.randomization)
            dynamics = sample_dynamics(num, ranges, self._generator)
        skill = sample_skills(num, self._references.num_skills, self._generator, schedule)
        return draw_starts(self._setup.robot, dynamics, skill, self._config, self._references, self._generator)

    def keep(self, starts: Starts, noise: float) -> None:
        """Have these ready, and what is observed in them with this share of the sensor noise."""
        self._take(starts)
        measurement = measure(self._setup.robot, starts.initial.robot_state())
        situation = Situation(
            self._setup,
            measurement,
            starts.command,
            starts.skill,
            self.action,
            starts.average_velocity,
            starts.dynamics,
            Before(self.action, measurement.joint_velocity),
        )
        seen = self._observer.frame(situation, noise)
        self.observed = Observed(self._observer.first(seen.observation), seen.privileged)

    def state_dict(self) -> dict[str, Any]:
        return {"starts": self.starts.state_dict(), "starts_observed": vars(self.observed)}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._take(Starts.from_state_dict(state["starts"]))
        self.observed = Observed(**state["starts_observed"])

    def _take(self, starts: Starts) -> None:
        self.starts = starts
        pose = constant(self._setup.robot.default_joint_position, starts.joint_target)
        self.action = (starts.joint_target - pose) / self._setup.action_scale
