"""The judge: a policy is rolled out in all situations, and what it did becomes a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camp.config.schema import Config
from camp.evaluation import arrays, gait
from camp.evaluation.config import EvaluationConfig
from camp.evaluation.plan import Command, Plan, disturbed_plan, grid_plan, one_per_gait, orders, switching_plan
from camp.evaluation.quality import summarize_quality
from camp.evaluation.reading import GridReading, read_grid
from camp.evaluation.robustness import summarize_robustness
from camp.evaluation.rollout import Policy, Recording, roll_out
from camp.evaluation.style import summarize_style
from camp.evaluation.switching import find_switches, summarize_switching
from camp.evaluation.tracking import summarize_tracking
from camp.evaluation.verdict import judge_targets
from camp.motion.clips.clip import Clip


@dataclass
class Judgement:
    """What was found out about a policy."""

    report: dict[str, Any]  # plain values, as in eval.json; see docs/evaluation.md
    arrays: dict[str, np.ndarray]  # as in eval.npz
    grid: Recording | None = None  # skill by skill, each at every command
    switching: Recording | None = None  # its first robot is the sequence to show


class Judge:
    """Judges policies by one yardstick.

    Args:
        config: of the policy: robot, skills, observation, noise.
        evaluation: what to do.
        clips: the expert's, of the policy's skills.
    """

    def __init__(self, config: Config, evaluation: EvaluationConfig, clips: list[Clip]):
        self.config, self.evaluation, self.clips = config, evaluation, clips
        self.skills = config.motion.skill_set()
        self._period = config.env.control_period_s
        self._friction = config.env.randomization.nominal_friction

    def judge(self, policy: Policy, baselines: dict[str, Policy] | None = None) -> Judgement:
        """All parts of the evaluation for ``policy``; ``baselines`` only walk the grid beside it."""
        evaluation = self.evaluation
        result = Judgement({}, arrays.common_arrays(self._period, self.skills))
        if evaluation.needs_grid:
            self._judge_grid(policy, baselines or {}, result)
        if "switching" in evaluation.parts:
            self._judge_switching(policy, result)
        if "robustness" in evaluation.parts:
            self._judge_robustness(policy, result)
        result.report["verdict"] = [finding.plain() for finding in judge_targets(result.report, evaluation.targets)]
        return result

    def _judge_grid(self, policy: Policy, baselines: dict[str, Policy], result: Judgement) -> None:
        parts, report = self.evaluation.parts, result.report
        result.grid = self._walk_grid(policy)
        reading = self._read(result.grid)
        report["policies"] = {"trained": gait.summarize(reading)}
        if "gait" in parts:
            report["policies"] |= {
                name: gait.summarize(self._read(self._walk_grid(one))) for name, one in baselines.items()
            }
            report["expert"] = gait.beside_expert(reading, self.skills, self.clips)
            report["performed"] = gait.performed_by_command(reading, self.evaluation.commands)
        if "tracking" in parts:
            report["tracking"] = summarize_tracking(reading)
        if "quality" in parts:
            report["quality"] = summarize_quality(reading)
        if "style" in parts:
            report["style"] = summarize_style(reading, self.skills, self.clips)
        result.arrays |= arrays.grid_arrays(result.grid, reading, self.evaluation.commands)

    def _judge_switching(self, policy: Policy, result: Judgement) -> None:
        wanted = self.evaluation.switching
        sequences = orders(one_per_gait(self.skills), wanted.orders)
        plan = switching_plan(sequences, wanted.commands, self._steps(wanted.skill_s), self._friction)
        recording = roll_out(policy, self.config, plan, self.clips, self.evaluation.seed)
        switches = find_switches(recording, self.skills)
        result.switching = recording
        result.report["switching"] = summarize_switching(recording, switches, self.skills, wanted.within_s)
        result.arrays |= arrays.switching_arrays(recording, switches)

    def _judge_robustness(self, policy: Policy, result: Judgement) -> None:
        wanted = self.evaluation.robustness
        conditions = wanted.all()
        plan = disturbed_plan(self._grid(wanted.commands), conditions, self._friction, wanted.push_period_s)
        recording = roll_out(policy, self.config, plan, self.clips, self.evaluation.seed)
        result.report["robustness"] = summarize_robustness(
            recording, [condition.name for condition in conditions], self.skills, self.evaluation.discard_s
        )

    def _walk_grid(self, policy: Policy) -> Recording:
        plan = self._grid(self.evaluation.commands)
        return roll_out(policy, self.config, plan, self.clips, self.evaluation.seed)

    def _grid(self, commands: Sequence[Command]) -> Plan:
        return grid_plan(len(self.skills), commands, self._steps(self.evaluation.duration_s), self._friction)

    def _read(self, recording: Recording) -> GridReading:
        return read_grid(recording, self.skills, self.evaluation.discard_s)

    def _steps(self, seconds: float) -> int:
        return round(seconds / self._period)
