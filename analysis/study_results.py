"""A study's result: every run's figures in one JSON, which tables and figures are drawn from."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from analysis.load import AnalysisError
from analysis.provenance import provenance
from analysis.reports import read_report
from analysis.study import Study, Thresholds, jobs_of
from analysis.study_runs import seconds_of, state_of
from camp.common.files import write_text
from camp.common.foreign import first_problem, foreign_file, read_json
from camp.runs.folder import METRICS, REPORT, VERSIONS
from camp.runs.metrics import read_metrics

RESULTS = Path("ablations/results")
CURVE_POINTS = 40
_ACCURACY = re.compile(r"gait/([^/]+)/accuracy")


@checked
class RunResult:
    """One run. right: walks that meet all criteria; labelled: commanded skill -> shown -> walks, by gait and stride
    frequency alone, so that a bound without flight still counts as one; switches_completed: fraction in time; curve:
    environment steps in millions and the fraction of robots that show their skill, mean over skills, while training."""

    arm: str
    seed: int
    iterations: int
    seconds: float
    suite: str
    right: int
    labelled: dict[str, dict[str, int]]
    switches_completed: float | None
    linear_error_m_s: float
    walks: int
    falls: int
    curve_steps: list[float]
    curve_accuracy: list[float]
    origin: dict[str, Any]  # commit, machine and versions that its training began with


@checked
class StudyResult:
    """All finished runs of a study, with the thresholds that were set before. origin: of what read them."""

    study: str
    question: str
    digest: str
    thresholds: Thresholds
    arms: list[str]
    runs: list[RunResult]
    missing: list[str]  # arm and seed of what is not done yet
    origin: dict[str, Any]

    def of_arm(self, arm: str) -> list[RunResult]:
        """The arm's runs."""
        return [run for run in self.runs if run.arm == arm]


_ADAPTER = TypeAdapter(StudyResult)


Kept = Mapping[tuple[str, int], RunResult]  # by arm and seed


def kept_runs(study: Study, path: Path) -> Kept:
    """The runs that a result on file has of this very study: their folders may be on another machine, or gone.

    Raises AnalysisError for a damaged file, and for the result of another version of the study's YAML, which would be
    overwritten.
    """
    if not path.is_file():
        return {}
    result = read_result(path, remedy="restore it, or delete it to begin anew")
    if result.digest != study.digest:
        raise AnalysisError(
            f"result {path}: made with another version of the study's YAML; restore that, or move the result elsewhere"
        )
    return {(run.arm, run.seed): run for run in result.runs}


def collect(study: Study, runs: Path, kept: Kept) -> StudyResult:
    """Read what is done of a study: run folders and, where there is none, what was kept."""
    found, missing = [], []
    for job in jobs_of(study):
        state, of_job = state_of(job, runs), (job.arm, job.seed)
        if state.folder is not None and state.done(study):
            found.append(_run_result(*of_job, state.folder))
        elif of_job in kept:
            found.append(kept[of_job])
        else:
            missing.append(f"{job.arm} seed {job.seed}")
    return StudyResult(
        study=study.name,
        question=study.question,
        digest=study.digest,
        thresholds=study.thresholds,
        arms=list(study.arms),
        runs=found,
        missing=missing,
        origin=provenance(),
    )


def _run_result(arm: str, seed: int, folder: Path) -> RunResult:
    report = read_report(folder)
    trained = report.policies["trained"]
    if not trained.labelled:
        raise AnalysisError(
            f"'{folder / REPORT}' does not tell which gaits were shown, as an older camp wrote it: delete it and give "
            "the study's command again"
        )
    completed = report.switching.all.completed if report.switching else None
    steps, accuracy = condensed_curve(read_metrics(folder / METRICS))
    return RunResult(
        arm=arm,
        seed=seed,
        iterations=report.iteration or 0,
        seconds=round(seconds_of(folder), 1),
        suite=f"{report.suite.name} {report.suite.digest}",
        right=sum(row[skill] for skill, row in trained.confusion.items()),
        labelled=trained.labelled,
        switches_completed=completed.value if completed else None,
        linear_error_m_s=trained.all.linear_error_m_s,
        walks=trained.all.rollouts,
        falls=trained.all.falls,
        curve_steps=steps,
        curve_accuracy=accuracy,
        origin=_origin(folder),
    )


def _origin(folder: Path) -> dict[str, Any]:
    path = folder / VERSIONS
    with foreign_file(path, f"'{path}' cannot be read", "restore it from a copy of the run", AnalysisError):
        versions = read_json(path.read_bytes())
        packages = {name: versions["packages"].get(name) for name in ("torch", "mujoco")}
        git = versions["git"] or {"commit": None, "dirty": None}
        return git | {name: versions[name] for name in ("platform", "cpu_count", "started")} | packages


def condensed_curve(rows: Sequence[dict[str, Any]]) -> tuple[list[float], list[float]]:
    """Steps in millions and the accuracy of training's own gait readings, mean over skills, at CURVE_POINTS places."""
    steps, accuracy = [], []
    for row in rows:
        read = [value for key, value in row.items() if _ACCURACY.fullmatch(key) and value is not None]
        if read and row.get("steps"):
            steps.append(row["steps"] / 1e6)
            accuracy.append(float(np.mean(read)))
    if not steps:
        return [], []
    places = np.linspace(steps[0], steps[-1], min(CURVE_POINTS, len(steps)))
    return places.round(4).tolist(), np.interp(places, steps, accuracy).round(4).tolist()


def result_path(name: str) -> Path:
    """Where a study's result is kept."""
    return RESULTS / f"{name}.json"


def write_result(path: Path, result: StudyResult) -> None:
    """Write the JSON whole. Raises ConfigError where the folder cannot be written."""
    write_text(path, json.dumps(asdict(result), indent=1) + "\n")  # type: ignore[call-overload]


def read_result(path: Path, remedy: str | None = None) -> StudyResult:
    """Read a study's JSON. Raises AnalysisError in one line with the remedy: the command that makes it."""
    remedy = remedy or f"make it with `make ablations STUDY=ablations/studies/{path.stem}.yaml`"
    try:
        return _ADAPTER.validate_json(path.read_bytes())
    except OSError as error:
        raise AnalysisError(f"result {path}: {error.strerror or error}; {remedy}") from error
    except ValidationError as error:
        raise AnalysisError(f"result {path}: {first_problem(error, 'the file')}; {remedy}") from error
