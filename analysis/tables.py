"""Table IV in numbers, with the paper's Yes and No by the study's thresholds, and what it was computed from."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from analysis.arms import ARMS, title_of
from analysis.measures import answer, distinct_gaits, gait_counts, information, over_seeds
from analysis.measures import paired_difference as difference
from analysis.study import Thresholds
from analysis.study_results import RunResult, StudyResult
from camp.common.markdown import pipe_table
from camp.metrics.statistics import Interval

REFERENCE = "full"
GAITS_SHOWN, INFORMATION = "gaits shown", "information (bits)"
NARROW = (GAITS_SHOWN, INFORMATION, "gait right", "switches in time")
Measure = Callable[[RunResult], float | None]


@dataclass(frozen=True)
class Table:
    """Rows of cells below a heading."""

    heading: list[str]
    rows: list[list[str]]

    def as_markdown(self) -> str:
        """A pipe table."""
        return pipe_table(self.heading, self.rows)

    def as_csv(self) -> str:
        """Comma-separated, the heading first."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([self.heading, *self.rows])
        return text.getvalue()

    def as_latex(self) -> str:
        """A tabular with booktabs."""
        columns = "l" + "c" * (len(self.heading) - 1)
        rows = [" & ".join(map(_latex, cells)) + r" \\" for cells in [self.heading, *self.rows]]
        body = "\n".join([r"\toprule", rows[0], r"\midrule", *rows[1:], r"\bottomrule"])
        return f"\\begin{{tabular}}{{{columns}}}\n{body}\n\\end{{tabular}}\n"


def _latex(text: str) -> str:
    for plain, escaped in (("%", r"\%"), ("_", r"\_"), ("&", r"\&"), ("−", "$-$")):
        text = text.replace(plain, escaped)
    return text


def measures(result: StudyResult) -> dict[str, Measure]:
    """The figures of a run by the heading that they stand below."""

    def counts(run: RunResult):
        return gait_counts(run.labelled)[2]

    shown = result.thresholds.shown_fraction
    return {
        GAITS_SHOWN: lambda run: float(distinct_gaits(counts(run), shown)),
        INFORMATION: lambda run: information(counts(run)),
        "gait right": lambda run: run.right / run.walks,
        "switches in time": lambda run: run.switches_completed,
        "velocity error (m/s)": lambda run: run.linear_error_m_s,
        "falls per walk": lambda run: run.falls / run.walks,
    }


def by_seed(runs: Sequence[RunResult], measure: Measure) -> dict[int, float]:
    """A measure of the runs that have it."""
    return {run.seed: value for run in runs if (value := measure(run)) is not None}


def ablation_table(result: StudyResult) -> Table:
    """A row for each arm: Yes or No beside the paper's, then all figures with 95-% intervals over seeds."""
    heading = ["arm", "seeds", "multiple gaits", "paper: gaits", "gait control switch", "paper: switch"]
    rows = []
    for arm in result.arms:
        found = figures(result, arm)
        (several, obeys), (paper_several, paper_obeys) = answers(found, result.thresholds), _papers(arm)
        said = [several, paper_several, obeys, paper_obeys]
        rows.append([title_of(arm), str(len(result.of_arm(arm))), *said, *map(interval_text, found.values())])
    return Table([*heading, *measures(result)], rows)


def narrow_table(result: StudyResult) -> Table:
    """What fits a printed page: the paper's answers in parentheses, and the measures in NARROW alone."""
    rows = []
    for arm in result.arms:
        found = figures(result, arm)
        both = zip(answers(found, result.thresholds), _papers(arm), strict=True)
        said = [f"{own} ({paper})" for own, paper in both]
        rows.append([title_of(arm), *said, *(interval_text(found[name]) for name in NARROW)])
    return Table(["arm", "multiple gaits", "control switch", *NARROW], rows)


def difference_table(result: StudyResult) -> Table:
    """A row for each arm but the full one: every figure minus the full one's of the same seed, with its interval."""
    known, rows = measures(result), []
    for arm in result.arms:
        if arm == REFERENCE:
            continue
        pairs = [
            difference(by_seed(result.of_arm(arm), measure), by_seed(result.of_arm(REFERENCE), measure))
            for measure in known.values()
        ]
        if any(pairs):
            rows.append([title_of(arm), *map(interval_text, pairs)])
    return Table([f"difference to {title_of(REFERENCE)}", *known], rows)


def seed_table(result: StudyResult) -> Table:
    """A row for each run, a number in each cell, for a program to read."""
    known = measures(result)
    rows = []
    for run in result.runs:
        values = (measure(run) for measure in known.values())
        rows.append([run.arm, str(run.seed), *("" if value is None else f"{value:.6g}" for value in values)])
    return Table(["arm", "seed", *known], rows)


def figures(result: StudyResult, arm: str) -> dict[str, Interval | None]:
    """An arm's measures by their heading, mean and interval over seeds."""
    runs = result.of_arm(arm)
    return {name: over_seeds(by_seed(runs, measure)) for name, measure in measures(result).items()}


def answers(found: Mapping[str, Interval | None], limits: Thresholds) -> tuple[str, str]:
    """Table IV's two: "Yes", "No" or "open" for several gaits, and for switching on command."""
    return answer(found[GAITS_SHOWN], limits.distinct_gaits), answer(found[INFORMATION], limits.information_bits)


def _papers(arm: str) -> tuple[str, str]:
    paper = ARMS[arm].paper if arm in ARMS else None
    if paper is None:
        return "-", "-"
    several, obeys = ("Yes" if said else "No" for said in paper)
    return several, obeys


def interval_text(found: Interval | None) -> str:
    """Mean and interval, the mean alone of a single seed."""
    if found is None:
        return "-"
    value, low, high = (f"{round(one, 2) + 0.0:.2f}" for one in (found.value, found.low, found.high))  # no "-0.00"
    return value if found.n == 1 else f"{value} [{low}, {high}]"
