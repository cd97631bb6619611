"""Schema of conf/env: types, units, ranges; ``check`` says which key is wrong and what to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any

from omegaconf import MISSING

from camp.common import checks
from camp.common.bounds import Fraction, Friction, Kick, Scale, Seconds, SecondsOrZero, Speed, Spin, Within
from camp.robots.amp_state import discriminator_state_size
from camp.sim.delay import LONGEST_DELAY

# Who gives commands and skills: random ones on a clock, or whoever calls `QuadrupedEnv.set_command`.
CLOCK, EXTERNAL = SOURCES = ("clock", "external")

SpinNoise = Annotated[float, Within(0.0, 100.0, "rad/s; three times a Go2's fastest joint")]
AngleNoise = Annotated[float, Within(0.0, 3.15, "rad; half a turn")]
Force = Annotated[float, Within(0.001, 1e5, "N; hundreds of times a robot's weight")]
Tilt = Annotated[float, Within(0.01, 10.0, "rad; beyond pi no tilt ends an episode")]
Payload = Annotated[float, Within(0.0, 100.0, "kg; several times the robot")]
PayloadPosition = Annotated[float, Within(-1.0, 1.0, "m; beyond the robot's own length")]
Delay = Annotated[float, Within(0.0, LONGEST_DELAY, "s; a third of a stride at 3 Hz")]
GrowthSeconds = Annotated[float, Within(0.001, 1e7, "s; a third of a year of each robot")]
FallRate = Annotated[float, Within(0.0, 1000.0, "per 1000 steps")]
ControlPeriod = Annotated[float, Within(0.001, 0.1, "s; slower nobody controls a gait of 3 strides per second")]
Age = Annotated[int, Within(0, 1000, "control steps; 20 s at 50 Hz")]
Frames = Annotated[int, Within(1, 100, "control steps; 2 s at 50 Hz")]


@dataclass
class NoiseConfig:
    """Half-widths of the uniform sensor noise on the policy's observation; the critic's own part has none."""

    enabled: bool = MISSING
    angular_velocity_rad_s: SpinNoise = MISSING
    gravity: Fraction = MISSING  # per component of the unit vector
    joint_position_rad: AngleNoise = MISSING
    joint_velocity_rad_s: SpinNoise = MISSING


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
    history: Frames = 1  # control steps whose entries the policy sees, the oldest first
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

    vx_m_s: list[Speed] = MISSING  # [low, high], forward
    vy_m_s: list[Speed] = MISSING  # [low, high], left
    yaw_rate_rad_s: list[Spin] = MISSING  # [low, high], counter-clockwise
    zero_component_fraction: Fraction = MISSING  # probability that a component is zero
    zero_fraction: Fraction = MISSING  # probability that the whole command is zero
    period_s: Seconds = MISSING  # a new command this often, counted from an episode's start
    skill_period_s: Seconds = MISSING  # a new skill this often, likewise
    # null: every draw is uniform. A number: draws that share time equally (0) or in proportion to failure (1).
    skill_focus: Fraction | None = None

    def check(self) -> None:
        checks.require(self.source in SOURCES, "env.command.source", self.source, f"choose {' or '.join(SOURCES)}")
        for name in ("vx_m_s", "vy_m_s", "yaw_rate_rad_s"):
            checks.interval(f"env.command.{name}", getattr(self, name))


@dataclass
class RewardConfig:
    """Task rewards: those of the paper's Table II, and any other terms of `camp.envs.rewards`."""

    # By term: its weight (absent or 0: not computed) and its parameters, numbers above 0. Names and parameters are
    # checked with the whole configuration, which knows the terms.
    terms: dict[str, dict[str, Any]] = field(default_factory=dict)
    velocity_average_s: SecondsOrZero = MISSING  # time constant of the average that is rewarded; 0: the velocity itself

    def weights(self) -> dict[str, float]:
        """Weight of every term that the environment computes, by its name."""
        weights = {name: float(values.get("weight", 0.0)) for name, values in self.terms.items()}
        return {name: weight for name, weight in weights.items() if weight != 0.0}


@dataclass
class TerminationConfig:
    """When an episode has failed."""

    body_contact_force_n: Force = MISSING  # ground reaction on base or thigh
    tilt_rad: Tilt = MISSING  # angle between the trunk's and the world's vertical


@dataclass
class RandomizationConfig:
    """Domain randomization (paper, Table I), drawn anew at every reset."""

    enabled: bool = MISSING  # false: the nominal robot
    nominal_friction: Friction = MISSING  # coefficient where it is disabled
    link_mass_scale: list[Scale] = MISSING  # times nominal, each link
    payload_mass_kg: list[Payload] = MISSING
    payload_position_m: list[PayloadPosition] = MISSING  # each axis, from the base origin
    friction: list[Friction] = MISSING  # foot-ground coefficient
    motor_strength_scale: list[Scale] = MISSING  # times the motor torque, each joint
    kp_scale: list[Scale] = MISSING  # times nominal, each joint
    kd_scale: list[Scale] = MISSING  # times nominal, each joint
    # From the measured state to the torque, all latencies together; not in Table I. A delayed observation is the same
    # closed loop as a delayed target.
    delay_s: list[Delay] = field(default_factory=lambda: [0.0, 0.0])

    def check(self) -> None:
        checks.interval("env.randomization.payload_position_m", self.payload_position_m)
        checks.interval("env.randomization.payload_mass_kg", self.payload_mass_kg)
        for name in ("link_mass_scale", "friction", "motor_strength_scale", "kp_scale", "kd_scale"):
            checks.interval(f"env.randomization.{name}", getattr(self, name))
        checks.interval("env.randomization.delay_s", self.delay_s)


@dataclass
class PushConfig:
    """Sudden changes of the base's horizontal velocity."""

    enabled: bool = MISSING
    period_s: Seconds = MISSING
    max_velocity_m_s: Kick = MISSING  # each horizontal axis, either way


@dataclass
class InitializationConfig:
    """Where episodes start."""

    reference_fraction: Fraction = MISSING  # of the resets, in a random frame of an expert clip of the commanded skill
    joint_position_scale: list[Scale] = MISSING  # the rest: standing, joints at default times this (Table I)

    def check(self) -> None:
        checks.interval("env.initialization.joint_position_scale", self.joint_position_scale)


@dataclass
class EpisodeGrowthConfig:
    """A curriculum: episodes begin short and double again and again, up to ``env.episode_s``."""

    initial_s: Seconds | None = None  # length of the first episodes; null: ``env.episode_s`` from the start
    doubling_s: GrowthSeconds = 28.8  # the length doubles whenever every robot has been simulated for this long
    # Once the length has grown to this many s, each skill's own success decides about its episodes, as
    # `camp.training.skill_curriculum` says; null: never.
    by_skill_from_s: Seconds | None = None
    success_up: Fraction = 0.7  # of a skill's stretches: its episodes grow at or above, ...
    success_down: Fraction = 0.4  # ... and shrink below

    def check(self) -> None:
        checks.require(
            self.by_skill_from_s is None or (self.initial_s is not None and self.by_skill_from_s >= self.initial_s),
            "env.episode_growth.by_skill_from_s",
            self.by_skill_from_s,
            f"choose null, or at least env.episode_growth.initial_s ({self.initial_s}), the length that grows",
        )
        checks.require(
            0.0 <= self.success_down <= self.success_up,
            "env.episode_growth.success_down",
            self.success_down,
            f"choose a fraction within 0 .. success_up ({self.success_up})",
        )


@dataclass
class HardeningConfig:
    """A curriculum: noise, randomization and pushes begin weak and grow while the gaits hold.

    See `camp.training.hardening`.
    """

    initial: Fraction | None = None  # difficulty in [0, 1] at the start; null: all of it from the start
    step: Fraction = 0.05  # of the difficulty, at one reading of the gaits (run.gait_every)
    accuracy_up: Fraction = 0.9  # harder where this fraction shows its gait, mean over skills, ...
    weakest_up: Fraction = 0.0  # ... and this fraction of each skill's robots, ...
    falls_per_1000_steps: FallRate = 1.0  # ... and no more fall
    accuracy_down: Fraction = 0.75  # easier below it

    def check(self) -> None:
        checks.require(
            0.0 <= self.accuracy_down <= self.accuracy_up,
            "env.hardening.accuracy_down",
            self.accuracy_down,
            f"choose a fraction within 0 .. accuracy_up ({self.accuracy_up})",
        )


@dataclass
class EnvConfig:
    """The whole group conf/env."""

    episode_s: Seconds = MISSING  # at most
    control_period_s: ControlPeriod = MISSING
    observe_skill: bool = MISSING  # false: the skill's entries of the observation are zero (ablation)
    # Ages in control steps of the states that the discriminators judge together, oldest first; [1, 0]: the paper's
    # two consecutive states. Older ones show the stride frequency.
    transition_ages: list[Age] = field(default_factory=lambda: [1, 0])
    # Whether their states also tell for which fraction of the last control step each foot stood: it shows a flight of
    # 10 ms, which states at 50 Hz hardly do.
    foot_stance: bool = False
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

    def transition_shape(self) -> tuple[int, int]:
        """(F, S) of what the discriminators judge: so many states, each of so many numbers."""
        return len(self.transition_ages), discriminator_state_size(self.foot_stance)

    def check(self) -> None:
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
            self.command,
            self.randomization,
            self.initialization,
        ):
            part.check()
