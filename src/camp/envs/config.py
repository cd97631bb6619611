"""Schema of conf/env: types, units, ranges; ``check`` says which key is wrong and what to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from omegaconf import MISSING

from camp.common import checks
from camp.sim.delay import LONGEST_DELAY

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
    # null: every draw is uniform. A number: draws that share time equally (0) or in proportion to failure (1).
    skill_focus: float | None = None

    def check(self) -> None:
        checks.require(self.source in SOURCES, "env.command.source", self.source, f"choose {' or '.join(SOURCES)}")
        for name in ("vx_m_s", "vy_m_s", "yaw_rate_rad_s"):
            checks.interval(f"env.command.{name}", getattr(self, name))
        checks.fraction("env.command.zero_component_fraction", self.zero_component_fraction)
        checks.fraction("env.command.zero_fraction", self.zero_fraction)
        checks.positive("env.command.period_s", self.period_s)
        checks.positive("env.command.skill_period_s", self.skill_period_s)
        if self.skill_focus is not None:
            checks.fraction("env.command.skill_focus", self.skill_focus)


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
    # From the measured state to the torque, all latencies together; not in Table I. A delayed observation is the same
    # closed loop as a delayed target.
    delay_s: list[float] = field(default_factory=lambda: [0.0, 0.0])

    def check(self) -> None:
        checks.positive("env.randomization.nominal_friction", self.nominal_friction)
        checks.interval("env.randomization.payload_position_m", self.payload_position_m)
        checks.not_negative_interval("env.randomization.payload_mass_kg", self.payload_mass_kg)
        for name in ("link_mass_scale", "friction", "motor_strength_scale", "kp_scale", "kd_scale"):
            checks.positive_interval(f"env.randomization.{name}", getattr(self, name))
        checks.not_negative_interval("env.randomization.delay_s", self.delay_s)
        checks.require(
            self.delay_s[1] <= LONGEST_DELAY,
            "env.randomization.delay_s",
            self.delay_s,
            f"choose at most {LONGEST_DELAY:g} s",
        )


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
class EpisodeGrowthConfig:
    """A curriculum: episodes begin short and double again and again, up to ``env.episode_s``."""

    initial_s: float | None = None  # length of the first episodes; null: ``env.episode_s`` from the start
    doubling_s: float = 28.8  # the length doubles whenever every robot has been simulated for this long
    # Once the length has grown to this many s, each skill's own success decides about its episodes, as
    # `camp.training.skill_curriculum` says; null: never.
    by_skill_from_s: float | None = None
    success_up: float = 0.7  # of a skill's stretches: its episodes grow at or above, ...
    success_down: float = 0.4  # ... and shrink below

    def check(self) -> None:
        checks.require(
            self.by_skill_from_s is None or (self.initial_s is not None and self.by_skill_from_s >= self.initial_s),
            "env.episode_growth.by_skill_from_s",
            self.by_skill_from_s,
            f"choose null, or at least env.episode_growth.initial_s ({self.initial_s}), the length that grows",
        )
        checks.fraction("env.episode_growth.success_up", self.success_up)
        checks.require(
            0.0 <= self.success_down <= self.success_up,
            "env.episode_growth.success_down",
            self.success_down,
            f"choose a fraction within 0 .. success_up ({self.success_up})",
        )
        checks.positive("env.episode_growth.doubling_s", self.doubling_s)


@dataclass
class HardeningConfig:
    """A curriculum: noise, randomization and pushes begin weak and grow while the gaits hold (`camp.hardening`)."""

    initial: float | None = None  # difficulty in [0, 1] at the start; null: all of it from the start
    step: float = 0.05  # of the difficulty, at one reading of the gaits (run.gait_every)
    accuracy_up: float = 0.9  # harder where this fraction shows its gait, mean over skills, ...
    falls_per_1000_steps: float = 1.0  # ... and no more fall
    accuracy_down: float = 0.75  # easier below it

    def check(self) -> None:
        if self.initial is not None:
            checks.fraction("env.hardening.initial", self.initial)
        checks.fraction("env.hardening.step", self.step)
        checks.fraction("env.hardening.accuracy_up", self.accuracy_up)
        checks.not_negative("env.hardening.falls_per_1000_steps", self.falls_per_1000_steps)
        checks.require(
            0.0 <= self.accuracy_down <= self.accuracy_up,
            "env.hardening.accuracy_down",
            self.accuracy_down,
            f"choose a fraction within 0 .. accuracy_up ({self.accuracy_up})",
        )


@dataclass
class EnvConfig:
    """The whole group conf/env."""

    episode_s: float = MISSING  # at most
    control_period_s: float = MISSING
    observe_skill: bool = MISSING  # false: the skill's entries of the observation are zero (ablation)
    # Ages in control steps of the states that the discriminators judge together, oldest first; [1, 0]: the paper's
    # two consecutive states. Older ones show the stride frequency.
    transition_ages: list[int] = field(default_factory=lambda: [1, 0])
    episode_growth: EpisodeGrowthConfig = field(default_factory=EpisodeGrowthConfig)
    hardening: HardeningConfig = field(default_factory=HardeningConfig)
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
        initial, period = self.episode_growth.initial_s, self.control_period_s
        checks.require(
            initial is None or period <= initial <= self.episode_s,
            "env.episode_growth.initial_s",
            initial,
            f"choose null, or a length within control_period_s .. episode_s ({period} .. {self.episode_s})",
        )
        ages = list(self.transition_ages)
        checks.require(
            len(ages) >= 2 and ages[-1] == 0 and ages == sorted(set(ages), reverse=True),
            "env.transition_ages",
            ages,
            "choose two or more ages in control steps, the oldest first and 0 last, such as [1, 0]",
        )
        for part in (
            self.episode_growth,
            self.hardening,
            self.noise,
            self.command,
            self.reward,
            self.termination,
            self.randomization,
            self.push,
            self.initialization,
        ):
            part.check()
