"""Schema of conf/evaluation/evaluate.yaml."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, cast

from omegaconf import MISSING, DictConfig, OmegaConf

from camp import checks
from camp.config import without_hydra


@dataclass
class EvaluationConfig:
    """What is rolled out and what is recorded."""

    run: str = MISSING  # folder that camp.train wrote
    duration_s: float = MISSING
    discard_s: float = MISSING
    # OmegaConf takes no whole number for a float in a nested list, so the numbers are checked here.
    commands: list[Any] = field(default_factory=list)  # (G, 3) vx, vy in m/s, yaw rate in rad/s
    switch_command: list[float] = field(default_factory=list)  # (3,)
    video: bool = MISSING
    video_command: int = MISSING  # index into commands
    video_s: float = MISSING

    def check(self) -> None:
        checks.positive("duration_s", self.duration_s)
        checks.not_negative("discard_s", self.discard_s)
        checks.require(
            self.duration_s - self.discard_s >= 2.0,
            "discard_s",
            self.discard_s,
            f"leave 2 s or more of the {self.duration_s} s for the gait metric",
        )
        checks.require(len(self.commands) > 0, "commands", list(self.commands), "give one [vx, vy, yaw rate] or more")
        for name, command in [
            ("switch_command", self.switch_command),
            *(("commands", c) for c in self.commands),
        ]:
            holds = isinstance(command, list) and len(command) == 3 and all(isinstance(v, int | float) for v in command)
            checks.require(holds, name, command, "give [vx, vy, yaw rate] in m/s, m/s, rad/s")
        last = len(self.commands) - 1
        checks.require(
            0 <= self.video_command <= last,
            "video_command",
            self.video_command,
            f"choose an index from 0 to {last}",
        )
        checks.positive("video_s", self.video_s)


def resolve_evaluation(config: DictConfig) -> EvaluationConfig:
    """The typed and checked configuration behind a composed one."""
    merged = OmegaConf.merge(OmegaConf.structured(EvaluationConfig), without_hydra(config))
    typed = cast(EvaluationConfig, OmegaConf.to_object(merged))
    typed.check()
    return typed
