"""Schema of conf/evaluation/evaluate.yaml."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, cast

from omegaconf import MISSING, DictConfig, OmegaConf

from camp.common import checks
from camp.config.resolve import without_hydra
from camp.evaluation.conditions import Condition, check_conditions

PARTS = ("gait", "switching", "tracking", "quality", "style", "robustness")


@dataclass
class SwitchingConfig:
    """The sequence through one skill of each gait."""

    skill_s: float = MISSING  # s of each skill
    within_s: float = MISSING  # until the new gait is to be established
    orders: int = MISSING  # at most, of the skills
    commands: list[Any] = field(default_factory=list)  # (G, 3); the first is the one that is filmed and drawn

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
        checks.count("switching.orders", self.orders)
        check_commands("switching.commands", self.commands)


@dataclass
class RobustnessConfig:
    """The grid under disturbance."""

    commands: list[Any] = field(default_factory=list)  # (G, 3)
    push_period_s: float = MISSING
    conditions: list[Any] = field(default_factory=list)  # see camp.evaluation.conditions

    def check(self) -> None:
        check_commands("robustness.commands", self.commands)
        checks.positive("robustness.push_period_s", self.push_period_s)
        checks.require(len(self.conditions) > 0, "robustness.conditions", [], "list one or more")
        check_conditions("robustness.conditions", self.conditions)

    def all(self) -> list[Condition]:
        return [Condition.of(entry) for entry in self.conditions]


@dataclass
class TargetsConfig:
    """What a policy is to reach; see docs/evaluation.md."""

    gait_accuracy: float = MISSING  # share, of the weakest skill
    switches_established: float = MISSING  # share
    falls_per_100_episodes: float = MISSING
    linear_error_m_s: float = MISSING
    yaw_rate_error_rad_s: float = MISSING
    joint_tracking: float = MISSING  # share, thigh and calf each

    def check(self) -> None:
        for name in ("gait_accuracy", "switches_established", "joint_tracking"):
            checks.fraction(f"targets.{name}", getattr(self, name))
        for name in ("falls_per_100_episodes", "linear_error_m_s", "yaw_rate_error_rad_s"):
            checks.not_negative(f"targets.{name}", getattr(self, name))


@dataclass
class EvaluationConfig:
    """What is rolled out and what is reported."""

    run: str = MISSING  # folder that camp.train wrote
    parts: list[str] = MISSING  # of PARTS
    baselines: bool = MISSING  # also an untrained policy and standing still
    seed: int = MISSING  # of sensor noise and pushes
    duration_s: float = MISSING
    discard_s: float = MISSING
    # OmegaConf takes no whole number for a float in a nested list, so the numbers are checked here.
    commands: list[Any] = field(default_factory=list)  # (G, 3) vx, vy in m/s, yaw rate in rad/s
    switching: SwitchingConfig = field(default_factory=SwitchingConfig)
    robustness: RobustnessConfig = field(default_factory=RobustnessConfig)
    targets: TargetsConfig = field(default_factory=TargetsConfig)
    video: bool = MISSING  # an mp4 of the switching sequence
    video_skills: bool = MISSING  # beside it one of each skill
    video_command: int = MISSING  # index into commands
    video_s: float = MISSING

    @property
    def needs_grid(self) -> bool:
        """Whether a part is read from the grid of commands."""
        return bool({"gait", "tracking", "quality", "style"} & set(self.parts))

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
        last = len(self.commands) - 1
        checks.require(
            0 <= self.video_command <= last, "video_command", self.video_command, f"choose an index from 0 to {last}"
        )
        checks.positive("video_s", self.video_s)
        for part in (self.switching, self.robustness, self.targets):
            part.check()


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
