"""What an engine's walks showed, judged by the criteria of suite v1; the result file, written and read by one class."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import TypeAdapter, ValidationError

from camp.common.errors import CampError
from camp.common.files import write_text
from camp.common.foreign import first_problem
from camp.deployment.loop import Policy
from camp.evaluation.config import EvaluationConfig
from camp.evaluation.contract import parse_skill
from camp.evaluation.report import SuiteStamp
from camp.evaluation.suite import file_digest, stamp
from camp.metrics.criteria import ContactLog, failures, read_walks
from camp.metrics.tracking import mean_velocity
from camp.robots.registry import DEFAULT_ROBOT, find_robot
from camp.robots.robot import Robot
from camp.transfer.description import describe
from camp.transfer.engine import READING_S, engine_version, start_engine
from camp.transfer.walks import EngineBody, Feet, Walk, walk

FORMAT: Literal[1] = 1


@dataclass
class Judged:
    """One walk. What needs an upright robot is None after a fall."""

    skill: str
    command: list[float]  # vx, vy in m/s, yaw rate in rad/s
    fell_after_s: float | None
    gait: str | None = None  # label of at least 90 % of the 1-s windows, or "none"
    frequency_hz: float | None = None  # None also where no rhythm is found
    velocity: list[float] | None = None  # mean, as the command
    failed: list[str] | None = None  # criteria of the commanded skill; [] for a walk that is right

    @property
    def right(self) -> bool:
        """Upright, and every criterion of the commanded skill is met."""
        return self.failed == []


@dataclass
class Result:
    """All walks of one policy in one engine."""

    format: Literal[1]
    kind: Literal["transfer"]
    robot: str
    policy: str  # name of its folder
    network: str  # digest of the exported file
    suite: SuiteStamp  # whose fixed commands, durations and criteria these are
    engine: str
    version: str
    timestep_s: float
    walks: list[Judged]


def judge(walk: Walk, skill: str, command: Sequence[float], period_s: float, discard_s: float) -> Judged:
    """Judge one walk without its first ``discard_s`` s; period_s: of the control steps."""
    if walk.fell:
        return Judged(skill, list(command), round(len(walk.velocity) * period_s, 6))
    first, readings = round(discard_s / period_s), round(period_s / READING_S)
    log = ContactLog(walk.contact[None, first * readings :], READING_S, walk.foot_height[None, first:], period_s)
    reading, wanted = read_walks(log), parse_skill(skill)
    found = failures(reading, wanted.gait, wanted.frequency_hz)
    hertz = float(reading.frequency_hz[0])
    return Judged(
        skill=skill,
        command=list(command),
        fell_after_s=None,
        gait=str(reading.gait[0]),
        frequency_hz=round(hertz, 4) if np.isfinite(hertz) else None,
        velocity=[round(float(value), 4) for value in mean_velocity(walk.velocity[first:], period_s)],
        failed=[name for name, value in found.items() if value[0]],
    )


@dataclass(frozen=True)
class Plan:
    """What is walked in every engine."""

    policy: Policy
    title: str  # of the policy
    digest: str  # of its exported file
    robot: Robot
    skills: list[str]
    evaluation: EvaluationConfig  # whose grid of fixed commands is walked


def walk_all(plan: Plan, name: str) -> Result:
    """Every skill at every command in one engine. Raises CampError where the engine is not installed."""
    metadata, feet, suite = plan.policy.metadata, Feet(plan.robot), plan.evaluation
    engine = start_engine(name, describe(plan.robot, metadata))
    walks = []
    for skill, command in product(plan.skills, suite.commands):
        engine.reset()
        done = walk(plan.policy, EngineBody(engine, metadata, feet), skill, command, suite.duration_s)
        walks.append(judge(done, skill, command, metadata["control_period"], suite.discard_s))
    return Result(
        format=FORMAT,
        kind="transfer",
        robot=plan.robot.name,
        policy=plan.title,
        network=plan.digest,
        suite=_stamp(suite, plan.robot),
        engine=name,
        version=engine_version(name),
        timestep_s=engine.timestep_s,
        walks=walks,
    )


def _stamp(suite: EvaluationConfig, robot: Robot) -> SuiteStamp:
    """The suite's name stands for its commands, durations and criteria, whoever walks."""
    return replace(stamp(suite, find_robot(DEFAULT_ROBOT)), robot=robot.name, model=file_digest(robot.model_path))


_ADAPTER = TypeAdapter(Result)


def write_result(path: Path, result: Result) -> None:
    """Write the result whole. Raises ConfigError where the folder cannot be written."""
    write_text(path, _ADAPTER.dump_json(result, indent=1).decode() + "\n")


def read_result(path: Path) -> Result:
    """Read a result. Raises CampError in one line for a file that is missing, damaged or something else."""
    try:
        return _ADAPTER.validate_json(path.read_bytes())
    except OSError as error:
        raise CampError(f"result {path}: {error.strerror or error}; walk again") from error
    except ValidationError as error:
        reason = first_problem(error)
        raise CampError(f"result {path}: no result of camp.transfer ({reason}); walk again, or remove it") from error


def read_results(folder: Path) -> list[Result]:
    """All results of a folder, in the order of its file names. Raises CampError where there is none."""
    files = sorted(folder.glob("*.json"))
    if not files:
        raise CampError(f"folder {folder}: holds no results; run `python -m camp.transfer <policy> engine=all` first")
    return [read_result(path) for path in files]
