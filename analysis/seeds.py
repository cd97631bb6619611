"""Several seeds of one variant side by side: `python -m analysis.seeds <run folder> <run folder> ...`.

Prints, as Markdown, every target with each seed's figure, then gait accuracy and stride frequency of every skill. What
is a sample here is the seed, never the roll-out: up to four seeds are shown by their least, median and greatest figure,
five or more by the interquartile mean with its stratified bootstrap interval. The runs must have been judged by one
suite (`python -m camp.evaluate run=<folder>`).
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

from analysis.load import AnalysisError, evaluation_folder
from analysis.reports import read_report
from camp.cli.key_values import run_command
from camp.common.markdown import pipe_table
from camp.evaluation.report import Estimate, GaitSummary, Report
from camp.metrics.statistics import Interval, seeds_interval
from camp.runs.folder import REPORT

USAGE = "python -m analysis.seeds <run folder> <run folder> ..."
FEWEST_FOR_INTERVALS = 5


@dataclass(frozen=True)
class TargetRow:
    """One target over the seeds; reached: one figure for each run, None where there was nothing to measure."""

    name: str
    target: float
    at_least: bool
    reached: tuple[float | None, ...]
    verdicts: tuple[str, ...]  # of each seed's own walks

    @property
    def known(self) -> list[float]:
        """The figures that there are."""
        return [value for value in self.reached if value is not None]

    @property
    def shown(self) -> int:
        """How many seeds show the target."""
        return self.verdicts.count("shown")


def check_comparable(reports: Sequence[Report]) -> None:
    """Raise AnalysisError where figures cannot stand side by side."""
    _check_alike("suite", [f"{report.suite.name} {report.suite.digest}" for report in reports])
    _check_alike("gait criteria", [report.suite.thresholds for report in reports])
    _check_alike("robot model", [report.suite.model for report in reports])
    for name in ("variant", "iteration", "parts", "skills"):
        _check_alike(name, [getattr(report, name) for report in reports])
    targets = [[(finding.name, finding.target, finding.at_least) for finding in report.verdict] for report in reports]
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
    for findings in zip(*(report.verdict for report in reports), strict=True):
        first = findings[0]
        reached, verdicts = (tuple(getattr(one, key) for one in findings) for key in ("reached", "verdict"))
        rows.append(TargetRow(first.name, first.target, first.at_least, reached, verdicts))
    return rows


def skill_scores(reports: Sequence[Report]) -> np.ndarray | None:
    """Gait accuracy (S seeds, K skills); None where gaits were not evaluated."""
    rows = [
        [accuracy(part) for part in report.policies["trained"].skills.values()]
        for report in reports
        if "trained" in report.policies
    ]
    return np.array(rows) if len(rows) == len(reports) else None


def accuracy(part: GaitSummary) -> float:
    """Fraction of right walks."""
    return part.gait_accuracy.value if part.gait_accuracy else float("nan")


def as_markdown(reports: Sequence[Report]) -> str:
    """The tables; without the walks there are no gaits to list."""
    seeds, many = [f"seed {report.seed}" for report in reports], len(reports) >= FEWEST_FOR_INTERVALS
    suite, walks = reports[0].suite, _walks(reports[0])
    lines = [f"suite {suite.name} ({suite.digest}), seed of the suite {suite.seed}, per training seed {walks}", ""]
    spread = ["mean of seeds, 95 %"] if many else ["least", "median", "greatest"]
    targets = []
    for row in target_rows(reports):
        bound = f"{'>=' if row.at_least else '<='} {row.target:g}"
        figures = [_figure(value) for value in row.reached]
        targets.append([row.name, bound, *figures, *_spread(row, many), f"{row.shown} of {len(seeds)}"])
    lines.append(pipe_table(["", "target", *seeds, *spread, "shown in"], targets))
    scores = skill_scores(reports)
    if scores is not None:
        trained = [report.policies["trained"].skills for report in reports]
        gaits = [[skill, *(_gait(skills[skill]) for skills in trained)] for skill in trained[0]]
        lines += ["", pipe_table(["gait right, stride", *seeds], gaits)]
        if many:
            lines += [
                "",
                f"gait accuracy over skills and seeds, interquartile mean: {_interval(seeds_interval(scores))}",
            ]
    return "\n".join(lines)


def _spread(row: TargetRow, many: bool) -> list[str]:
    """What the seeds' figures have in common."""
    if len(row.known) < len(row.reached):
        return ["-"] if many else ["-"] * 3
    if many:
        return [_interval(seeds_interval(np.array(row.known)[:, None]))]
    return [_figure(value) for value in (min(row.known), median(row.known), max(row.known))]


def _walks(report: Report) -> str:
    trained = report.policies.get("trained")
    counts = [f"{trained.all.rollouts} walks"] if trained else []
    counts += [f"{report.table_i.walks.all.rollouts} under Table I"] if report.table_i else []
    counts += [f"{report.switching.all.switches} switches"] if report.switching else []
    return ", ".join(counts) or "no walks"


def _gait(gait: GaitSummary) -> str:
    return f"{_fraction(gait.gait_accuracy)}, {_figure(gait.frequency_hz, 2)} Hz"


def _fraction(found: Estimate | None) -> str:
    if found is None:
        return "-"
    return f"{100 * found.value:.0f} % [{100 * found.low:.0f}, {100 * found.high:.0f}] of {found.n}"


def _interval(found: Interval) -> str:
    return f"{found.value:.3f} [{found.low:.3f}, {found.high:.3f}]"


def _figure(value: float | None, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def print_tables(arguments: Sequence[str]) -> None:
    """Print the tables of the run folders, in order of their seeds. Raises AnalysisError."""
    if not arguments:
        raise AnalysisError(f"no run folder is given: call `{USAGE}`")
    folders = [Path(argument.removeprefix("run=")) for argument in arguments]
    reports = [read_report(folder) for folder in folders]
    check_comparable(reports)
    order = sorted(range(len(reports)), key=lambda i: (reports[i].seed is None, reports[i].seed))
    print(as_markdown([reports[i] for i in order]))
    print("\nread from " + ", ".join(str(evaluation_folder(folders[i]) / REPORT) for i in order))


def main(arguments: list[str]) -> int:
    """Print the tables; returns the exit code, 2 where a line on stderr says what is missing."""
    return run_command(print_tables, arguments, __doc__)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
