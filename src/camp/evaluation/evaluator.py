"""The judge: a policy walks in all situations, all robots in one batch, and what they did becomes a report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from camp.common.errors import ConfigError
from camp.common.progress import Track, silently
from camp.evaluation import arrays, gait
from camp.evaluation.config import NEEDS_GRID, EvaluationConfig
from camp.evaluation.contract import Contract
from camp.evaluation.controllers import Controller, robot_of
from camp.evaluation.plan import Plan, Planner
from camp.evaluation.quality import summarize_quality
from camp.evaluation.reading import Reading, read
from camp.evaluation.recording import Recording, record
from camp.evaluation.reference import summarize_reference
from camp.evaluation.report import FORMAT, Report
from camp.evaluation.robustness import summarize_robustness
from camp.evaluation.rollout import Setting, Trace, roll_out
from camp.evaluation.style import summarize_style
from camp.evaluation.suite import stamp
from camp.evaluation.switching import find_switches, summarize_switching
from camp.evaluation.tracking import summarize_tracking
from camp.evaluation.verdict import judge_targets
from camp.motion.clips.clip import Clip
from camp.motion.clips.sampler import ReferenceStates

MakeController = Callable[[], Controller]


@dataclass
class Judgement:
    """What was found out about a policy."""

    report: Report
    arrays: dict[str, np.ndarray]  # as in eval.npz
    grid: Recording | None = None  # skill by skill, each at every command
    switching: Recording | None = None  # its first robot is the sequence to show


@dataclass
class Subject:
    """Who is judged. controller: makes one anew for each part of the evaluation; the rest as in `Report`."""

    name: str
    contract: Contract
    controller: MakeController
    policy: str | None = None
    variant: str | None = None
    iteration: int | None = None
    seed: int | None = None
    baselines: dict[str, MakeController] = field(default_factory=dict)  # walk beside it


class Evaluator:
    """Judges policies by one yardstick.

    Args:
        evaluation: what to do.
        clips: the expert's.
        track: shows how far the work is.
    """

    def __init__(self, evaluation: EvaluationConfig, clips: list[Clip], track: Track = silently):
        self.evaluation, self.clips, self._track = evaluation, clips, track

    def judge(self, subject: Subject) -> Judgement:
        """All parts of the evaluation. Raises ConfigError for a skill of which there are no clips."""
        evaluation, contract = self.evaluation, subject.contract
        skills = contract.skill_set
        clips = [clip for clip in self.clips if any(s.includes(clip.gait, clip.frequency_hz) for s in skills)]
        robot = robot_of(contract)
        planner = Planner(
            evaluation,
            robot,
            skills,
            contract.control_period_s,
            contract.command_range,
            ReferenceStates(clips, skills),
        )
        result = Judgement(
            self._empty_report(subject, planner), arrays.common_arrays(contract.control_period_s, skills)
        )
        plans = self._plans(planner)
        if not plans:
            raise ConfigError(f"parts = {list(evaluation.parts)}: nothing to roll out; choose more")
        baseline = planner.walks(evaluation.walks.baseline_per_skill, "walks") if subject.baselines else None
        jobs = [(plan, subject.controller()) for plan in plans.values()]
        jobs += [(baseline, make()) for make in subject.baselines.values() if baseline is not None]
        setting = Setting(
            period_s=contract.control_period_s,
            robot=robot,
            noise=evaluation.noise,
            push_period_s=evaluation.push_period_s,
            seed=evaluation.seed,
            threads=evaluation.threads,
        )
        traces = roll_out(jobs, setting, self._track)
        readers = {
            "walks": self._read_walks,
            "table_i": self._read_table_i,
            "grid": self._read_grid,
            "switching": self._read_switching,
            "robustness": self._read_robustness,
        }
        for name, trace in self._track(list(zip(plans, traces, strict=False)), "measuring, parts"):
            readers[name](trace, planner, clips, result)
        for name, trace in zip(subject.baselines, traces[len(plans) :], strict=True):
            result.report.policies[name] = gait.summarize(self._read(record(trace), planner))
        result.report.verdict = judge_targets(result.report, evaluation.targets)
        return result

    def _plans(self, planner: Planner) -> dict[str, Plan]:
        """What the parts asked for need, in the order in which it is read."""
        wants, result = self.evaluation.wants, {}
        if wants("gait", "tracking"):
            result["walks"] = planner.walks(self.evaluation.walks.per_skill, "walks")
        if wants("table_i"):
            result["table_i"] = planner.table_i()
        if wants(*NEEDS_GRID):
            result["grid"] = planner.grid()
        if wants("switching"):
            result["switching"] = planner.switching()
        if wants("robustness"):
            result["robustness"] = planner.robustness()
        return result

    def _read(self, recording: Recording, planner: Planner) -> Reading:
        return read(recording, planner.skills, self.evaluation.discard_s)

    def _read_walks(self, trace: Trace, planner: Planner, clips: list[Clip], result: Judgement) -> None:
        reading, report = self._read(record(trace), planner), result.report
        if self.evaluation.wants("gait"):
            report.policies["trained"] = gait.summarize(reading)
            report.expert = gait.beside_expert(reading, clips)
        if self.evaluation.wants("tracking"):
            report.tracking = summarize_tracking(reading)
        result.arrays |= arrays.walk_arrays("walk", reading)

    def _read_table_i(self, trace: Trace, planner: Planner, clips: list[Clip], result: Judgement) -> None:
        reading, friction = self._read(record(trace), planner), trace.plan.dynamics.friction.numpy()
        result.report.table_i = gait.summarize_table_i(reading, friction, list(self.evaluation.table_i.friction_edges))
        result.arrays |= arrays.walk_arrays("table_i", reading) | {"table_i_friction": friction}

    def _read_grid(self, trace: Trace, planner: Planner, clips: list[Clip], result: Judgement) -> None:
        result.grid = record(trace)
        reading, report, wants = self._read(result.grid, planner), result.report, self.evaluation.wants
        report.performed = gait.performed_by_command(reading, self.evaluation.commands)
        if wants("quality"):
            report.quality = summarize_quality(planner.robot, reading)
        if wants("reference"):
            report.reference = summarize_reference(planner.robot, reading, clips)
        if wants("style"):
            report.style = summarize_style(reading, planner.skills, clips)
        result.arrays |= arrays.grid_arrays(reading, self.evaluation.commands)

    def _read_switching(self, trace: Trace, planner: Planner, clips: list[Clip], result: Judgement) -> None:
        result.switching = record(trace)
        switches = find_switches(result.switching, planner.skills)
        within = self.evaluation.switching.within_s
        result.report.switching = summarize_switching(planner.robot, result.switching, switches, planner.skills, within)
        result.arrays |= arrays.switching_arrays(result.switching, switches)

    def _read_robustness(self, trace: Trace, planner: Planner, clips: list[Clip], result: Judgement) -> None:
        names = [condition.name for condition in self.evaluation.robustness.all()]
        result.report.robustness = summarize_robustness(self._read(record(trace), planner), names)

    def _empty_report(self, subject: Subject, planner: Planner) -> Report:
        return Report(
            format=FORMAT,
            suite=stamp(self.evaluation, planner.robot),
            run=subject.name,
            variant=subject.variant,
            iteration=subject.iteration,
            seed=subject.seed,
            policy=subject.policy,
            skills=[skill.name for skill in planner.skills],
            parts=list(self.evaluation.parts),
            duration_s=self.evaluation.duration_s,
            discard_s=self.evaluation.discard_s,
            commands_clipped=planner.clips_commands,
            policies={},
            expert={},
            performed={},
            table_i=None,
            tracking={},
            quality={},
            reference={},
            style={},
            switching=None,
            robustness={},
            verdict=[],
        )
