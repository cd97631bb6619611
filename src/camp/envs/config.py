"""Schema of conf/env: types, units, ranges; ``check`` says which key is wrong and what to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from omegaconf import MISSING

from camp.common import checks

# Who gives commands and skills: random ones on a clock, or whoever calls `QuadrupedEnv.set_command`.
CLOCK, EXTERNAL = SOURCES = ("clock", "external")


@dataclass
class NoiseConfig:
    """Half-widths of the uniform sensor noise on the policy's observation; the critic's own part has none."""

    enabled: bool = MISSING
    angular_velocity_rad_s: float = MISSING
    gravity: float = MISSING  # per component of the unit vector
    joint_position_rad: float = MISSING
    joint_velocity_rad_s: float = MISSING

    def check(self) -> None:
        for name in ("angular_velocity_rad_s", "gravity", "joint_position_rad", "joint_velocity_rad_s"):
            checks.not_negative(f"env.noise.{name}", getattr(self, name))


@dataclass
class ObservationConfig:
    """What is observed: names of entries of `camp.envs.observations`, in order.

    The defaults are what run folders were trained with that do not say. Names are checked with the whole configuration,
    which knows the entries.
    """

    policy: list[str] = field(
        default_factory=lambda: [
            "base_angular_velocity",
            "gravity",
            "command",
            "joint_position",
            "joint_velocity",
            "last_action",
            "skill",
        ]
    )
    critic: list[str] = field(  # besides what the policy observes, without noise
        default_factory=lambda: [
            "base_linear_velocity",
            "base_height",
            "foot_contact",
            "average_velocity",
            "link_mass_scale",
            "payload_mass",
            "payload_position",
            "friction",
            "motor_strength",
            "kp_scale",
            "kd_scale",
        ]
    )


@dataclass
class CommandConfig:
    """Velocity commands and skills."""

    source: str = "clock"  # of CLOCK and EXTERNAL

    vx_m_s: list[float] = MISSING  # [low, high], forward
    vy_m_s: list[float] = MISSING  # [low, high], left
    yaw_rate_rad_s: list[float] = MISSING  # [low, high], counter-clockwise
    zero_component_fraction: float = MISSING  # probability that a component is zero
    zero_fraction: float = MISSING  # probability that the whole command is zero
    period_s: float = MISSING  # a new command this often, counted from an episode's start
    skill_period_s: float = MISSING  # a new skill this often, likewise

    def check(self) -> None:
        checks.require(self.source in SOURCES, "env.command.source", self.source, f"choose {' or '.join(SOURCES)}")
        for name in ("vx_m_s", "vy_m_s", "yaw_rate_rad_s"):
            checks.interval(f"env.command.{name}", getattr(self, name))
        checks.fraction("env.command.zero_component_fraction", self.zero_component_fraction)
        checks.fraction("env.command.zero_fraction", self.zero_fraction)
        checks.positive("env.command.period_s", self.period_s)
        checks.positive("env.command.skill_period_s", self.skill_period_s)


@dataclass
class RewardConfig:
    """Task rewards: those of the paper's Table II, and any other terms of `camp.envs.rewards`."""

    # By term: its weight (absent or 0: not computed) and its parameters, numbers above 0. Names and parameters are
    # checked with the whole configuration, which knows the terms.
    terms: dict[str, dict[str, Any]] = field(default_factory=dict)
    velocity_average_s: float = MISSING  # time constant of the average that is rewarded; 0: the velocity itself

    def weights(self) -> dict[str, float]:
        """Weight of every term that the environment computes, by its name."""
        weights = {name: float(values.get("weight", 0.0)) for name, values in self.terms.items()}
        return {name: weight for name, weight in weights.items() if weight != 0.0}

    def check(self) -> None:
        checks.not_negative("env.reward.velocity_average_s", self.velocity_average_s)


@dataclass
class TerminationConfig:
    """When an episode has failed."""

    body_contact_force_n: float = MISSING  # ground reaction on base or thigh
    tilt_rad: float = MISSING  # angle between the trunk's and the world's vertical

    def check(self) -> None:
        checks.positive("env.termination.body_contact_force_n", self.body_contact_force_n)
        checks.positive("env.termination.tilt_rad", self.tilt_rad)


@dataclass
class RandomizationConfig:
    """Domain randomization (paper, Table I), drawn anew at every reset."""

    enabled: bool = MISSING  # false: the nominal robot
    nominal_friction: float = MISSING  # coefficient where it is disabled
    link_mass_scale: list[float] = MISSING  # times nominal, each link
    payload_mass_kg: list[float] = MISSING
    payload_position_m: list[float] = MISSING  # each axis, from the base origin
    friction: list[float] = MISSING  # foot-ground coefficient
    motor_strength_scale: list[float] = MISSING  # times the motor torque, each joint
    kp_scale: list[float] = MISSING  # times nominal, each joint
    kd_scale: list[float] = MISSING  # times nominal, each joint

    def check(self) -> None:
        checks.positive("env.randomization.nominal_friction", self.nominal_friction)
        checks.interval("env.randomization.payload_position_m", self.payload_position_m)
        checks.not_negative_interval("env.randomization.payload_mass_kg", self.payload_mass_kg)
        for name in ("link_mass_scale", "friction", "motor_strength_scale", "kp_scale", "kd_scale"):
            checks.positive_interval(f"env.randomization.{name}", getattr(self, name))


@dataclass
class PushConfig:
    """Sudden changes of the base's horizontal velocity."""

    enabled: bool = MISSING
    period_s: float = MISSING
    max_velocity_m_s: float = MISSING  # each horizontal axis, either way

    def check(self) -> None:
        checks.positive("env.push.period_s", self.period_s)
        checks.not_negative("env.push.max_velocity_m_s", self.max_velocity_m_s)


@dataclass
class InitializationConfig:
    """Where episodes start."""

    reference_fraction: float = MISSING  # of the resets, in a random frame of an expert clip of the commanded skill
    joint_position_scale: list[float] = MISSING  # the rest: standing, joints at default times this (Table I)

    def check(self) -> None:
        checks.fraction("env.initialization.reference_fraction", self.reference_fraction)
        checks.positive_interval("env.initialization.joint_position_scale", self.joint_position_scale)


@dataclass
class EnvConfig:
    """The whole group conf/env."""

    episode_s: float = MISSING
    control_period_s: float = MISSING
    observe_skill: bool = MISSING  # false: the skill's entries of the observation are zero (ablation)
    observation: ObservationConfig = field(default_factory=ObservationConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    command: CommandConfig = field(default_factory=CommandConfig)
    reward: RewardConfig = field(default_factory=RewardConfig)
    termination: TerminationConfig = field(default_factory=TerminationConfig)
    randomization: RandomizationConfig = field(default_factory=RandomizationConfig)
    push: PushConfig = field(default_factory=PushConfig)
    initialization: InitializationConfig = field(default_factory=InitializationConfig)

    def check(self) -> None:
        checks.positive("env.control_period_s", self.control_period_s)
        checks.require(
            self.episode_s >= self.control_period_s,
            "env.episode_s",
            self.episode_s,
            f"choose at least one control period ({self.control_period_s} s)",
        )
        for part in (
            self.noise,
            self.command,
            self.reward,
            self.termination,
            self.randomization,
            self.push,
            self.initialization,
        ):
            part.check()
