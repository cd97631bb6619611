"""Schema of conf/evaluation: what is judged, and the suite by which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, cast

from omegaconf import MISSING, DictConfig, OmegaConf

from camp.common import checks
from camp.common.bounds import (
    Fraction,
    Friction,
    Kick,
    Scale,
    Seconds,
    SecondsOrZero,
    Seed,
    Speed,
    Spin,
    Threads,
    Within,
    bounds_of,
    check_number,
    check_numbers,
)
from camp.config.resolve import without_hydra
from camp.envs.config import NoiseConfig, RandomizationConfig
from camp.evaluation.conditions import Condition, check_conditions

PARTS = ("gait", "table_i", "switching", "tracking", "quality", "reference", "style", "robustness")
NEEDS_GRID = ("quality", "reference", "style")

Walks = Annotated[int, Within(1, 100_000, "walks are kept in memory together")]
WalkSeconds = Annotated[float, Within(0.02, 600.0, "s; walks are kept in memory step by step")]
SequenceLength = Annotated[int, Within(2, 1000, "skills one after the other; a switch needs two")]
Falls = Annotated[float, Within(0.0, 100.0, "per 100 episodes")]
Error = Annotated[float, Within(0.0, 100.0, "m/s or rad/s")]
Index = Annotated[int, Within(0, 10_000, "an index into the commands")]


@dataclass
class CommandsConfig:
    """The distribution of random commands: uniform, with a fraction of the components, or of all three, at zero."""

    vx_m_s: list[Speed] = MISSING  # [low, high], forward
    vy_m_s: list[Speed] = MISSING  # [low, high], left
    yaw_rate_rad_s: list[Spin] = MISSING  # [low, high], counter-clockwise
    zero_component_fraction: Fraction = MISSING
    zero_fraction: Fraction = MISSING

    def check(self) -> None:
        for name in ("vx_m_s", "vy_m_s", "yaw_rate_rad_s"):
            checks.interval(f"random_commands.{name}", getattr(self, name))


@dataclass
class WalksConfig:
    """Random walks: a random command each, from a standing pose or from the midst of another gait's stride."""

    per_skill: Walks = MISSING
    baseline_per_skill: Walks = MISSING  # of each policy that does not walk
    standing_fraction: Fraction = MISSING  # of the starts; the rest begin in a frame of an expert clip of another gait
    standing_scale: list[Scale] = MISSING  # the default pose's joint angles times this

    def check(self) -> None:
        checks.interval("walks.standing_scale", self.standing_scale)


@dataclass
class TableIConfig:
    """Random walks under the whole of the paper's Table I at once, with sensor noise and pushes."""

    per_skill: Walks = MISSING
    push_m_s: Kick = MISSING
    friction_edges: list[Friction] = MISSING  # of the bins of the friction curve

    def check(self) -> None:
        edges = list(self.friction_edges)
        checks.require(edges == sorted(set(edges)), "table_i.friction_edges", edges, "give rising numbers")


@dataclass
class SwitchingConfig:
    """Every switch between two skills, from moving robots."""

    skill_s: WalkSeconds = MISSING  # s of each skill
    within_s: WalkSeconds = MISSING  # until the new skill is to be completed
    skills_per_sequence: SequenceLength = MISSING
    commands_per_switch: Walks = MISSING  # random commands at which each switch is made once

    def check(self) -> None:
        # Established means held for a second, and a switch too late to be seen would count as none.
        least = self.within_s + 1.0
        checks.require(
            least <= self.skill_s,
            "switching.skill_s",
            self.skill_s,
            f"choose {least:g} s or more: switching.within_s and the second for which the gait is to be held",
        )


@dataclass
class RobustnessConfig:
    """Random walks under one disturbance at a time."""

    per_skill: Walks = MISSING
    conditions: list[Any] = field(default_factory=list)  # see camp.evaluation.conditions

    def check(self) -> None:
        checks.require(len(self.conditions) > 0, "robustness.conditions", [], "list one or more")
        check_conditions("robustness.conditions", self.conditions)

    def all(self) -> list[Condition]:
        return [Condition.of(entry) for entry in self.conditions]


@dataclass
class SuiteConfig:
    """Everything that decides what is measured: its digest stands in every result (`camp.evaluation.suite`)."""

    name: str = MISSING
    seed: Seed = MISSING
    parts: list[str] = MISSING  # of PARTS
    duration_s: WalkSeconds = MISSING  # of every walk
    discard_s: SecondsOrZero = MISSING  # of each walk, until the gait has settled
    random_commands: CommandsConfig = field(default_factory=CommandsConfig)
    walks: WalksConfig = field(default_factory=WalksConfig)
    table_i: TableIConfig = field(default_factory=TableIConfig)
    switching: SwitchingConfig = field(default_factory=SwitchingConfig)
    robustness: RobustnessConfig = field(default_factory=RobustnessConfig)
    # OmegaConf takes no whole number for a float in a nested list, so the numbers are checked here.
    commands: list[Any] = field(default_factory=list)  # (G, 3) of the grid: vx, vy in m/s, yaw rate in rad/s
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    randomization: RandomizationConfig = field(default_factory=RandomizationConfig)
    push_period_s: Seconds = MISSING

    def wants(self, *parts: str) -> bool:
        """Whether one of the parts is to be evaluated."""
        return bool(set(parts) & set(self.parts))

    def check(self) -> None:
        check_numbers("", self)
        parts, remedy = list(self.parts), f"choose from {', '.join(PARTS)}, each once"
        checks.require(bool(parts) and set(parts) <= set(PARTS), "parts", parts, remedy)
        checks.require(len(set(parts)) == len(parts), "parts", parts, remedy)
        checks.require(
            self.duration_s - self.discard_s >= 2.0,
            "discard_s",
            self.discard_s,
            f"leave 2 s or more of the {self.duration_s} s for the gait metric",
        )
        check_commands("commands", self.commands)
        for part in (
            self.random_commands,
            self.walks,
            self.table_i,
            self.switching,
            self.robustness,
            self.randomization,
        ):
            part.check()


@dataclass
class TargetsConfig:
    """What a policy is to reach; see docs/evaluation.md."""

    gait_accuracy: Fraction = MISSING  # fraction, of the weakest skill
    table_i_accuracy: Fraction = MISSING  # fraction, of all walks under Table I
    switches_completed: Fraction = MISSING  # fraction
    falls_per_100_episodes: Falls = MISSING
    linear_error_m_s: Error = MISSING
    yaw_rate_error_rad_s: Error = MISSING


@dataclass
class EvaluationConfig(SuiteConfig):
    """conf/evaluation/evaluate.yaml: the suite, and what is not part of it."""

    run: str = MISSING  # folder that camp.train wrote
    baselines: bool = MISSING  # also policies that do not walk
    targets: TargetsConfig = field(default_factory=TargetsConfig)
    threads: Threads = MISSING  # of the simulation, 0 for one per processor
    video: bool = MISSING  # an mp4 of the first switching sequence
    video_high: bool = MISSING  # 1280 x 720 pixels, 50 pictures per second, smooth edges
    video_skills: bool = MISSING  # beside it one of each skill
    video_command: Index = MISSING  # index into commands
    video_s: WalkSeconds = MISSING

    def check(self) -> None:
        super().check()
        last = len(self.commands) - 1
        checks.require(
            0 <= self.video_command <= last, "video_command", self.video_command, f"choose an index from 0 to {last}"
        )


def check_commands(key: str, commands: Sequence[Any]) -> None:
    """Raise ConfigError unless there is a command, and each is three numbers in their bounds."""
    checks.require(len(commands) > 0, key, list(commands), "give one [vx, vy, yaw rate] or more")
    for command in commands:
        holds = isinstance(command, list) and len(command) == 3
        checks.require(holds, key, command, "give [vx, vy, yaw rate] in m/s, m/s, rad/s")
        for value, within in zip(command, (bounds_of(Speed), bounds_of(Speed), bounds_of(Spin)), strict=True):
            check_number(key, value, within)


def resolve_evaluation(config: DictConfig) -> EvaluationConfig:
    """The typed and checked configuration behind a composed one."""
    merged = OmegaConf.merge(OmegaConf.structured(EvaluationConfig), without_hydra(config))
    typed = cast(EvaluationConfig, OmegaConf.to_object(merged))
    typed.check()
    return typed
