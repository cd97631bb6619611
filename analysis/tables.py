"""Table IV in numbers, with the paper's Yes and No by the study's thresholds: Markdown, LaTeX and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from analysis.arms import ARMS, title_of
from analysis.measures import answer, distinct_gaits, gait_counts, information, over_seeds
from analysis.measures import paired_difference as difference
from analysis.study_results import RunResult, StudyResult
from camp.metrics.statistics import Interval

REFERENCE = "full"
Measure = Callable[[RunResult], float | None]


@dataclass(frozen=True)
class Table:
    """Rows of cells below a heading."""

    heading: list[str]
    rows: list[list[str]]

    def as_markdown(self) -> str:
        """A pipe table."""
        lines = [self.heading, ["---"] * len(self.heading), *self.rows]
        return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)

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
        "gaits shown": lambda run: float(distinct_gaits(counts(run), shown)),
        "information (bits)": lambda run: information(counts(run)),
        "gait right": lambda run: run.right / run.walks,
        "switches in time": lambda run: run.switches_completed,
        "velocity error (m/s)": lambda run: run.linear_error_m_s,
        "falls per walk": lambda run: run.falls / run.walks,
    }


def by_seed(runs: Sequence[RunResult], measure: Measure) -> dict[int, float]:
    """A measure of the runs that have it."""
    return {run.seed: value for run in runs if (value := measure(run)) is not None}


def ablation_table(result: StudyResult) -> Table:
    """A row for each arm: Yes or No beside the paper's, then the figures with 95-% intervals over seeds, and the paired
    difference in information against the full method."""
    known = measures(result)
    heading = ["arm", "seeds", "multiple gaits", "paper", "gait control switch", "paper", *known, "bits - full's"]
    rows = []
    information = known["information (bits)"]
    reference = by_seed(result.of_arm(REFERENCE), information)
    for arm in result.arms:
        runs = result.of_arm(arm)
        found = {name: over_seeds(by_seed(runs, measure)) for name, measure in known.items()}
        limits = result.thresholds
        paper = ARMS[arm].paper if arm in ARMS else None
        several, obeys = ("Yes" if said else "No" for said in paper) if paper else ("-", "-")
        against = None if arm == REFERENCE else difference(by_seed(runs, information), reference)
        rows.append(
            [
                title_of(arm),
                str(len(runs)),
                answer(found["gaits shown"], limits.distinct_gaits),
                several,
                answer(found["information (bits)"], limits.information_bits),
                obeys,
                *(interval_text(found[name]) for name in known),
                interval_text(against),
            ]
        )
    return Table(heading, rows)


def interval_text(found: Interval | None) -> str:
    """Mean and interval, the mean alone of a single seed."""
    if found is None:
        return "-"
    if found.n == 1:
        return f"{found.value:.2f}"
    return f"{found.value:.2f} [{found.low:.2f}, {found.high:.2f}]"
