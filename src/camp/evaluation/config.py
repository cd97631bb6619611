"""Schema of conf/evaluation: what is judged, and the suite by which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, cast

from omegaconf import MISSING, DictConfig, OmegaConf

from camp.common import checks
from camp.config.resolve import without_hydra
from camp.envs.config import NoiseConfig, RandomizationConfig
from camp.evaluation.conditions import Condition, check_conditions

PARTS = ("gait", "table_i", "switching", "tracking", "quality", "reference", "style", "robustness")
NEEDS_GRID = ("quality", "reference", "style")


@dataclass
class CommandsConfig:
    """The distribution of random commands: uniform, with a fraction of the components, or of all three, at zero."""

    vx_m_s: list[float] = MISSING  # [low, high], forward
    vy_m_s: list[float] = MISSING  # [low, high], left
    yaw_rate_rad_s: list[float] = MISSING  # [low, high], counter-clockwise
    zero_component_fraction: float = MISSING
    zero_fraction: float = MISSING

    def check(self) -> None:
        for name in ("vx_m_s", "vy_m_s", "yaw_rate_rad_s"):
            checks.interval(f"random_commands.{name}", getattr(self, name))
        checks.fraction("random_commands.zero_component_fraction", self.zero_component_fraction)
        checks.fraction("random_commands.zero_fraction", self.zero_fraction)


@dataclass
class WalksConfig:
    """Random walks: a random command each, from a standing pose or from the midst of another gait's stride."""

    per_skill: int = MISSING
    baseline_per_skill: int = MISSING  # of each policy that does not walk
    standing_fraction: float = MISSING  # of the starts; the rest begin in a frame of an expert clip of another gait
    standing_scale: list[float] = MISSING  # the default pose's joint angles times this

    def check(self) -> None:
        checks.count("walks.per_skill", self.per_skill)
        checks.count("walks.baseline_per_skill", self.baseline_per_skill)
        checks.fraction("walks.standing_fraction", self.standing_fraction)
        checks.positive_interval("walks.standing_scale", self.standing_scale)


@dataclass
class TableIConfig:
    """Random walks under the whole of the paper's Table I at once, with sensor noise and pushes."""

    per_skill: int = MISSING
    push_m_s: float = MISSING
    friction_edges: list[float] = MISSING  # of the bins of the friction curve

    def check(self) -> None:
        checks.count("table_i.per_skill", self.per_skill)
        checks.not_negative("table_i.push_m_s", self.push_m_s)
        edges = list(self.friction_edges)
        checks.require(edges == sorted(set(edges)), "table_i.friction_edges", edges, "give rising numbers")


@dataclass
class SwitchingConfig:
    """Every switch between two skills, from moving robots."""

    skill_s: float = MISSING  # s of each skill
    within_s: float = MISSING  # until the new skill is to be completed
    skills_per_sequence: int = MISSING
    commands_per_switch: int = MISSING  # random commands at which each switch is made once

    def check(self) -> None:
        checks.positive("switching.within_s", self.within_s)
        # Established means held for a second, and a switch too late to be seen would count as none.
        least = self.within_s + 1.0
        checks.require(
            least <= self.skill_s < float("inf"),
            "switching.skill_s",
            self.skill_s,
            f"choose {least:g} s or more: switching.within_s and the second for which the gait is to be held",
        )
        checks.require(
            self.skills_per_sequence >= 2, "switching.skills_per_sequence", self.skills_per_sequence, "choose 2 or more"
        )
        checks.count("switching.commands_per_switch", self.commands_per_switch)


@dataclass
class RobustnessConfig:
    """Random walks under one disturbance at a time."""

    per_skill: int = MISSING
    conditions: list[Any] = field(default_factory=list)  # see camp.evaluation.conditions

    def check(self) -> None:
        checks.count("robustness.per_skill", self.per_skill)
        checks.require(len(self.conditions) > 0, "robustness.conditions", [], "list one or more")
        check_conditions("robustness.conditions", self.conditions)

    def all(self) -> list[Condition]:
        return [Condition.of(entry) for entry in self.conditions]


@dataclass
class SuiteConfig:
    """Everything that decides what is measured: its digest stands in every result (`camp.evaluation.suite`)."""

    name: str = MISSING
    seed: int = MISSING
    parts: list[str] = MISSING  # of PARTS
    duration_s: float = MISSING  # of every walk
    discard_s: float = MISSING  # of each walk, until the gait has settled
    random_commands: CommandsConfig = field(default_factory=CommandsConfig)
    walks: WalksConfig = field(default_factory=WalksConfig)
    table_i: TableIConfig = field(default_factory=TableIConfig)
    switching: SwitchingConfig = field(default_factory=SwitchingConfig)
    robustness: RobustnessConfig = field(default_factory=RobustnessConfig)
    # OmegaConf takes no whole number for a float in a nested list, so the numbers are checked here.
    commands: list[Any] = field(default_factory=list)  # (G, 3) of the grid: vx, vy in m/s, yaw rate in rad/s
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    randomization: RandomizationConfig = field(default_factory=RandomizationConfig)
    push_period_s: float = MISSING

    def wants(self, *parts: str) -> bool:
        """Whether one of the parts is to be evaluated."""
        return bool(set(parts) & set(self.parts))

    def check(self) -> None:
        parts, remedy = list(self.parts), f"choose from {', '.join(PARTS)}, each once"
        checks.require(bool(parts) and set(parts) <= set(PARTS), "parts", parts, remedy)
        checks.require(len(set(parts)) == len(parts), "parts", parts, remedy)
        checks.seed("seed", self.seed)
        checks.positive("duration_s", self.duration_s)
        checks.not_negative("discard_s", self.discard_s)
        checks.require(
            self.duration_s - self.discard_s >= 2.0,
            "discard_s",
            self.discard_s,
            f"leave 2 s or more of the {self.duration_s} s for the gait metric",
        )
        check_commands("commands", self.commands)
        checks.positive("push_period_s", self.push_period_s)
        for part in (
            self.random_commands,
            self.walks,
            self.table_i,
            self.switching,
            self.robustness,
            self.noise,
            self.randomization,
        ):
            part.check()


@dataclass
class TargetsConfig:
    """What a policy is to reach; see docs/evaluation.md."""

    gait_accuracy: float = MISSING  # fraction, of the weakest skill
    table_i_accuracy: float = MISSING  # fraction, of all walks under Table I
    switches_completed: float = MISSING  # fraction
    falls_per_100_episodes: float = MISSING
    linear_error_m_s: float = MISSING
    yaw_rate_error_rad_s: float = MISSING

    def check(self) -> None:
        for name in ("gait_accuracy", "table_i_accuracy", "switches_completed"):
            checks.fraction(f"targets.{name}", getattr(self, name))
        for name in ("falls_per_100_episodes", "linear_error_m_s", "yaw_rate_error_rad_s"):
            checks.not_negative(f"targets.{name}", getattr(self, name))


@dataclass
class EvaluationConfig(SuiteConfig):
    """conf/evaluation/evaluate.yaml: the suite, and what is not part of it."""

    run: str = MISSING  # folder that camp.train wrote
    baselines: bool = MISSING  # also policies that do not walk
    targets: TargetsConfig = field(default_factory=TargetsConfig)
    threads: int = MISSING  # of the simulation, 0 for one per processor
    video: bool = MISSING  # an mp4 of the first switching sequence
    video_skills: bool = MISSING  # beside it one of each skill
    video_command: int = MISSING  # index into commands
    video_s: float = MISSING

    def check(self) -> None:
        super().check()
        last = len(self.commands) - 1
        checks.require(
            0 <= self.video_command <= last, "video_command", self.video_command, f"choose an index from 0 to {last}"
        )
        checks.positive("video_s", self.video_s)
        checks.not_negative("threads", self.threads)
        self.targets.check()


def check_commands(key: str, commands: Sequence[Any]) -> None:
    """Raise ConfigError unless there is a command, and each is three finite numbers."""
    checks.require(len(commands) > 0, key, list(commands), "give one [vx, vy, yaw rate] or more")
    for command in commands:
        holds = isinstance(command, list) and len(command) == 3 and all(map(_is_number, command))
        checks.require(holds, key, command, "give [vx, vy, yaw rate] in m/s, m/s, rad/s")


def resolve_evaluation(config: DictConfig) -> EvaluationConfig:
    """The typed and checked configuration behind a composed one."""
    merged = OmegaConf.merge(OmegaConf.structured(EvaluationConfig), without_hydra(config))
    typed = cast(EvaluationConfig, OmegaConf.to_object(merged))
    typed.check()
    return typed


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
