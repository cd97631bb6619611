"""Several seeds of one variant side by side: `python -m analysis.seeds <run folder> <run folder> ...`.

Prints, as Markdown, every target with each seed's figure and the worst of them, then gait accuracy and stride
frequency of every skill. The runs must have been evaluated alike (`python -m camp.evaluate run=<folder>`).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.load import AnalysisError, evaluation_folder
from camp.arguments import run_command
from camp.evaluation.verdict import Finding

REPORT_FILE = "eval.json"
SAME = ("variant", "iteration", "parts", "duration_s", "discard_s")  # keys of eval.json in which compared runs agree


@dataclass(frozen=True)
class TargetRow:
    """One target over the seeds.

    target and reached are in the unit that `name` gives; reached: one figure for each run, None where there was
    nothing to measure; at_least: whether the target is a lower bound.
    """

    name: str
    target: float
    at_least: bool
    reached: tuple[float | None, ...]

    @property
    def worst(self) -> float | None:
        """The figure of the seed furthest from the target; None where any seed has none."""
        known = [value for value in self.reached if value is not None]
        if len(known) < len(self.reached):
            return None
        return min(known) if self.at_least else max(known)

    @property
    def met(self) -> int:
        """How many seeds met the target."""
        return sum(Finding(self.name, self.target, value, self.at_least).met for value in self.reached)


def read_report(run: Path) -> dict[str, Any]:
    """eval.json of a run folder. Raises AnalysisError where it is missing or damaged."""
    path = evaluation_folder(run) / REPORT_FILE
    remedy = f"run `python -m camp.evaluate run={run}` first"
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
        for key in (*SAME, "seed", "policies", "verdict"):
            report[key]
    except OSError as error:
        raise AnalysisError(f"'{path}' cannot be read ({error.strerror}): {remedy}") from error
    except (ValueError, KeyError, TypeError) as error:
        raise AnalysisError(f"'{path}' is no evaluation's report ({error}): {remedy}") from error
    return report


def check_comparable(reports: Sequence[dict[str, Any]]) -> None:
    """Raises AnalysisError where the runs differ in what was trained or judged, as far as their reports tell."""
    for key in SAME:
        values = [report[key] for report in reports]
        if any(value != values[0] for value in values):
            listed = ", ".join(str(value) for value in values)
            raise AnalysisError(f"the runs differ in {key} ({listed}): compare seeds of one variant, evaluated alike")
    targets = [[(finding["name"], finding["target"]) for finding in report["verdict"]] for report in reports]
    if any(one != targets[0] for one in targets):
        raise AnalysisError("the runs were judged by different targets: evaluate them alike")
    seeds = [report["seed"] for report in reports]
    if len(set(seeds)) < len(seeds):
        raise AnalysisError(f"the runs have the seeds {', '.join(map(str, seeds))}: give one run of each")


def target_rows(reports: Sequence[dict[str, Any]]) -> list[TargetRow]:
    """The verdict's targets in their order, with the figures of all runs."""
    rows = []
    for findings in zip(*(report["verdict"] for report in reports), strict=True):
        first = findings[0]
        reached = tuple(finding["reached"] for finding in findings)
        rows.append(TargetRow(first["name"], first["target"], first["at_least"], reached))
    return rows


def as_markdown(reports: Sequence[dict[str, Any]]) -> str:
    """Both tables."""
    seeds = [f"seed {report['seed']}" for report in reports]
    lines = _head(["", "target", *seeds, "worst", "met"])
    for row in target_rows(reports):
        bound = f"{'>=' if row.at_least else '<='} {row.target:g}"
        figures = [_figure(value) for value in (*row.reached, row.worst)]
        lines.append(_row([row.name, bound, *figures, f"{row.met} of {len(seeds)}"]))
    lines += ["", *_head(["gait right, stride", *seeds])]
    for skill in reports[0]["policies"]["trained"]["skills"]:
        cells = [report["policies"]["trained"]["skills"][skill] for report in reports]
        lines.append(
            _row([skill, *(f"{100 * c['gait_accuracy']:.0f} %, {_figure(c['frequency_hz'], 2)} Hz" for c in cells)])
        )
    return "\n".join(lines)


def _head(cells: Sequence[str]) -> list[str]:
    return [_row(cells), "|---" * len(cells) + "|"]


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _figure(value: float | None, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def print_tables(arguments: Sequence[str]) -> None:
    """Print the tables of the run folders, in order of their seeds. Raises AnalysisError."""
    reports = [read_report(Path(argument.removeprefix("run="))) for argument in arguments]
    check_comparable(reports)
    print(as_markdown(sorted(reports, key=lambda report: report["seed"])))


def main(arguments: list[str]) -> int:
    """Print the tables; returns the exit code, 2 where a line on stderr says what is missing."""
    if not arguments:
        print(__doc__)
        return 2
    return run_command(print_tables, arguments, __doc__)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
