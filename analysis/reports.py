"""The entries of an evaluation's report, eval.json, by which runs are compared."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.load import AnalysisError, evaluation_folder
from camp.evaluation.verdict import Finding
from camp.runs.folder import REPORT

SAME = ("variant", "iteration", "parts", "duration_s", "discard_s")  # keys in which compared runs agree


@dataclass(frozen=True)
class SkillGait:
    """How the policy walks under one commanded skill."""

    accuracy: float  # fraction of the roll-outs that show it
    frequency_hz: float | None  # None where no robot steps


@dataclass(frozen=True)
class Report:
    """What is compared between runs.

    same: by the keys of `SAME`; gaits: by skill, none where the grid was not part of the evaluation; commands: names
    of the grid's, none where gaits were not.
    """

    seed: int
    same: dict[str, Any]
    findings: tuple[Finding, ...]
    gaits: dict[str, SkillGait]
    commands: tuple[str, ...]


def read_report(run: Path) -> Report:
    """The evaluation of a run folder. Raises AnalysisError where it is missing or damaged."""
    path = evaluation_folder(run) / REPORT
    remedy = f"run `python -m camp.evaluate run={run}` first"
    try:
        return parse_report(json.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise AnalysisError(f"'{path}' cannot be read ({error.strerror}): {remedy}") from error
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        reason = f"no entry {error}" if isinstance(error, KeyError) else error
        raise AnalysisError(f"'{path}' is no evaluation's report ({reason}): {remedy}") from error


def parse_report(content: dict[str, Any]) -> Report:
    """The content of an eval.json. Raises KeyError for a missing entry, another error for a wrong one."""
    skills = content["policies"]["trained"]["skills"] if "policies" in content else {}
    shown = list(content.get("performed", {}).values())
    return Report(
        seed=_whole_number(content["seed"], "seed"),
        same={key: content[key] for key in SAME},
        findings=tuple(_finding(entry) for entry in content["verdict"]),
        gaits={name: _gait(entry) for name, entry in skills.items()},
        commands=tuple(shown[0].keys()) if shown else (),
    )


def _finding(entry: dict[str, Any]) -> Finding:
    name, at_least = entry["name"], entry["at_least"]
    if not isinstance(name, str) or not isinstance(at_least, bool):
        raise TypeError(f"verdict holds {entry!r}")
    target, reached = _number(entry["target"], name), entry["reached"]
    return Finding(name, target, None if reached is None else _number(reached, name), at_least)


def _gait(entry: dict[str, Any]) -> SkillGait:
    frequency = entry["frequency_hz"]
    return SkillGait(
        _number(entry["gait_accuracy"], "gait_accuracy"),
        None if frequency is None else _number(frequency, "frequency_hz"),
    )


def _number(value: Any, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{name} is {value!r}, no number")
    return float(value)


def _whole_number(value: Any, name: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"{name} is {value!r}, no whole number")
    return value
