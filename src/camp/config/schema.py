"""The typed configuration of training: one dataclass per group of conf/, checked before anything is built.

Values live in YAML (conf/); here are the types, the units and the ranges.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from omegaconf import MISSING

from camp.algo.config import AlgoConfig
from camp.common import checks
from camp.common.bounds import Seed, Within, check_numbers
from camp.envs.config import EnvConfig
from camp.envs.observations import check_names
from camp.envs.rewards import check_terms
from camp.gaits.gait import GAITS
from camp.gaits.skills import FREQUENCY_TOLERANCE
from camp.motion.config import MotionConfig
from camp.robots.config import RobotConfig
from camp.robots.quadruped import NUM_LEGS
from camp.robots.registry import find_robot
from camp.runs.config import LoggerConfig
from camp.sim.config import SimConfig

Iterations = Annotated[int, Within(1, 10**8, "years of training")]
IterationsOrNone = Annotated[int, Within(0, 10**8, "years of training")]
RolloutSteps = Annotated[int, Within(1, 10_000, "control steps; all of them are kept in memory")]
GaitWindow = Annotated[float, Within(1.0, 3600.0, "s; two slow strides at least")]


@dataclass
class RunConfig:
    """conf/run: how long and how often."""

    iterations: Iterations = MISSING  # of collecting and updating
    rollout_steps: RolloutSteps = MISSING  # control steps per iteration and environment
    critic_warmup: IterationsOrNone = MISSING  # first ones that train critic and priors alone (after imitation)
    checkpoint_every: Iterations = MISSING  # iterations
    checkpoints_kept: Iterations = MISSING
    gait_window_s: GaitWindow = MISSING  # of foot contacts that a live gait reading looks at
    gait_every: Iterations = MISSING  # iterations between live readings of gaits and of the logits of D


@dataclass
class Config:
    """All of conf/train.yaml."""

    seed: Seed = MISSING
    variant: str = MISSING  # names and groups the run
    device: str = MISSING  # of the learner: auto, cpu, cuda, cuda:1
    output_dir: str = MISSING
    resume: str | None = MISSING  # a run folder to continue
    env: EnvConfig = field(default_factory=EnvConfig)
    sim: SimConfig = field(default_factory=SimConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    algo: AlgoConfig = field(default_factory=AlgoConfig)
    run: RunConfig = field(default_factory=RunConfig)
    logger: LoggerConfig = field(default_factory=LoggerConfig)

    def check(self) -> None:
        """Raise ConfigError for the first value that cannot work, alone or beside another."""
        check_numbers("", self)
        allowed = "letters, digits, '.', '_' and '-'"
        for key in ("output_dir", "resume"):
            checks.place(key, getattr(self, key))
        clean = bool(self.variant) and all(c.isalnum() or c in "._-" for c in self.variant)
        checks.require(clean, "variant", self.variant, f"name it with {allowed}")
        for part in (self.env, self.sim, self.robot, self.motion, self.algo, self.logger):
            part.check()
        check_terms(self.env.reward.terms)
        check_names("env.observation.policy", self.env.observation.policy)
        check_names("env.observation.critic", self.env.observation.critic)
        self._check_control_period()
        self._check_imitation()
        self._check_success_is_measured()
        samples = self.run.rollout_steps * self.sim.num_envs
        checks.require(
            samples >= self.algo.ppo.minibatches,
            "algo.ppo.minibatches",
            self.algo.ppo.minibatches,
            f"choose at most run.rollout_steps x sim.num_envs ({samples})",
        )

    def _check_control_period(self) -> None:
        substeps = self.env.control_period_s / self.sim.physics_timestep_s
        checks.require(
            abs(substeps - round(substeps)) < 1e-6 and round(substeps) >= 1,
            "env.control_period_s",
            self.env.control_period_s,
            f"choose a multiple of sim.physics_timestep_s ({self.sim.physics_timestep_s} s)",
        )
        checks.require(
            not self.env.foot_stance or round(substeps) >= 2,
            "env.foot_stance",
            self.env.foot_stance,
            "choose false, or a sim.physics_timestep_s of at most half of env.control_period_s: a fraction of one "
            "physics step tells nothing",
        )

    def _check_imitation(self) -> None:
        imitation = self.algo.imitation
        checks.require(
            self.algo.ppo.update_normalizer or imitation.epochs > 0,
            "algo.ppo.update_normalizer",
            self.algo.ppo.update_normalizer,
            "set it to true without imitation (algo.imitation.epochs=0), or observations are never scaled",
        )
        robot = find_robot(self.robot.name)
        gains = (tuple(self.robot.kp) * NUM_LEGS, tuple(self.robot.kd) * NUM_LEGS)
        checks.require(
            imitation.epochs == 0 or gains == (robot.pd_gain_p, robot.pd_gain_d),
            "robot.kp",
            list(self.robot.kp),
            f"the expert's targets are made for the gains of robot={robot.name}; use those, or run=scratch",
        )
        frequencies = list(self.motion.frequencies_hz)
        walked = sorted(set.intersection(*(set(GAITS[gait].duty) for gait in self.motion.skills)))
        checks.require(
            imitation.epochs == 0 or set(frequencies) <= set(walked),
            "motion.frequencies_hz",
            frequencies,
            f"the expert that is imitated walks at {', '.join(f'{hz:g}' for hz in walked)} Hz; choose from these "
            f"(clips within {FREQUENCY_TOLERANCE:.0%} are taken), or run=scratch",
        )

    def _check_success_is_measured(self) -> None:
        remedy = "leave it out without a skill discriminator (algo.skill.enabled=false), which measures success"
        for key, value in (
            ("env.episode_growth.by_skill_from_s", self.env.episode_growth.by_skill_from_s),
            ("env.command.skill_focus", self.env.command.skill_focus),
        ):
            checks.require(self.algo.skill.enabled or value is None, key, value, remedy)
