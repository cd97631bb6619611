"""Several seeds of one variant side by side: `python -m analysis.seeds <run folder> <run folder> ...`.

Prints, as Markdown, every target with each seed's figure and the worst of them, then gait accuracy and stride
frequency of every skill. The runs must have been evaluated alike (`python -m camp.evaluate run=<folder>`).
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.load import AnalysisError
from analysis.reports import SAME, Report, SkillGait, read_report
from camp.cli.key_values import run_command
from camp.evaluation.verdict import Finding

USAGE = "python -m analysis.seeds <run folder> <run folder> ..."


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


def check_comparable(reports: Sequence[Report]) -> None:
    """Raises AnalysisError where the runs differ in what was trained or judged, as far as their reports tell."""
    for key in SAME:
        _check_alike(key, [report.same[key] for report in reports])
    _check_alike("skills", [list(report.gaits) for report in reports])
    _check_alike("commands", [list(report.commands) for report in reports])
    targets = [[(finding.name, finding.target, finding.at_least) for finding in report.findings] for report in reports]
    if any(one != targets[0] for one in targets):
        raise AnalysisError("the runs were judged by different targets: evaluate them alike")
    seeds = [report.seed for report in reports]
    if len(set(seeds)) < len(seeds):
        raise AnalysisError(f"the runs have the seeds {', '.join(map(str, seeds))}: give one run of each")


def _check_alike(name: str, values: Sequence[object]) -> None:
    if any(value != values[0] for value in values):
        listed = ", ".join(str(value) for value in values)
        raise AnalysisError(f"the runs differ in {name} ({listed}): compare seeds of one variant, evaluated alike")


def target_rows(reports: Sequence[Report]) -> list[TargetRow]:
    """The verdict's targets in their order, with the figures of all runs."""
    rows = []
    for findings in zip(*(report.findings for report in reports), strict=True):
        first = findings[0]
        rows.append(TargetRow(first.name, first.target, first.at_least, tuple(finding.reached for finding in findings)))
    return rows


def as_markdown(reports: Sequence[Report]) -> str:
    """Both tables; without the grid there are no gaits to list."""
    seeds = [f"seed {report.seed}" for report in reports]
    lines = _head(["", "target", *seeds, "worst", "met"])
    for row in target_rows(reports):
        bound = f"{'>=' if row.at_least else '<='} {row.target:g}"
        figures = [_figure(value) for value in (*row.reached, row.worst)]
        lines.append(_row([row.name, bound, *figures, f"{row.met} of {len(seeds)}"]))
    if skills := reports[0].gaits:
        lines += ["", *_head(["gait right, stride", *seeds])]
        lines += [_row([skill, *(_gait(report.gaits[skill]) for report in reports)]) for skill in skills]
    return "\n".join(lines)


def _head(cells: Sequence[str]) -> list[str]:
    return [_row(cells), "|---" * len(cells) + "|"]


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _gait(gait: SkillGait) -> str:
    return f"{100 * gait.accuracy:.0f} %, {_figure(gait.frequency_hz, 2)} Hz"


def _figure(value: float | None, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def print_tables(arguments: Sequence[str]) -> None:
    """Print the tables of the run folders, in order of their seeds. Raises AnalysisError."""
    if not arguments:
        raise AnalysisError(f"no run folder is given: call `{USAGE}`")
    reports = [read_report(Path(argument.removeprefix("run="))) for argument in arguments]
    check_comparable(reports)
    print(as_markdown(sorted(reports, key=lambda report: report.seed)))


def main(arguments: list[str]) -> int:
    """Print the tables; returns the exit code, 2 where a line on stderr says what is missing."""
    return run_command(print_tables, arguments, __doc__)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
