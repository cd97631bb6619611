"""The table of engines: figures of every result, as printed and as Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Group
from rich.table import Table

from camp.common.markdown import pipe_table
from camp.evaluation.cells import cell, fitted, fraction_cells, percent, table
from camp.evaluation.contract import parse_skill
from camp.evaluation.report import Estimate
from camp.evaluation.values import fraction, mean
from camp.metrics.tracking import velocity_error
from camp.robots.registry import ROBOTS
from camp.transfer.engine import ENGINES
from camp.transfer.results import Judged, Result

TABLE_WIDTH = 80  # characters
HEADINGS = ("n", "right, 95 %", "label", "falls", "Hz ratio", "v err", "yaw err")
EXPLANATION = """right: upright, and every criterion of docs/judge.md; label: upright, and the
gait's name. Hz ratio: stride frequency / commanded; v err in m/s, yaw err in
rad/s: of the mean velocity. These three are means over the upright walks."""


@dataclass(frozen=True)
class Figures:
    """What some walks of one engine show."""

    right: Estimate | None
    label: Estimate | None
    falls: int
    frequency_ratio: float | None
    linear_error_m_s: float | None
    yaw_rate_error_rad_s: float | None


def figures(walks: Sequence[Judged]) -> Figures:
    """Figures of some walks."""
    named = [walk.gait == parse_skill(walk.skill).gait for walk in walks]
    upright = [walk for walk in walks if walk.velocity is not None]
    error = velocity_error(
        np.array([walk.command for walk in upright]).reshape(-1, 3),
        np.array([walk.velocity for walk in upright]).reshape(-1, 3),
    )
    return Figures(
        right=fraction(np.array([walk.right for walk in walks], dtype=bool)),
        label=fraction(np.array(named, dtype=bool)),
        falls=sum(walk.fell_after_s is not None for walk in walks),
        frequency_ratio=mean(np.array(frequency_ratios(upright))),
        linear_error_m_s=mean(error.linear),
        yaw_rate_error_rad_s=mean(error.angular),
    )


def frequency_ratios(walks: Iterable[Judged]) -> list[float]:
    """Measured stride frequency over the commanded one, of the walks that have both."""
    pairs = [(walk.frequency_hz, parse_skill(walk.skill).frequency_hz) for walk in walks]
    return [measured / asked for measured, asked in pairs if measured is not None and asked is not None]


def skills_of(results: Sequence[Result]) -> list[str]:
    """Every skill that was walked, in the order of the first result."""
    return list(dict.fromkeys(walk.skill for result in results for walk in result.walks))


def ordered(results: Sequence[Result]) -> list[Result]:
    """By robot as the registry lists them, and policy, and within these as ENGINES lists them."""
    robots = {name: number for number, name in enumerate(ROBOTS)}  # a result may be of one that is not there
    engines = list(ENGINES)

    def place(one: Result) -> tuple[int, str, str, int]:
        return robots.get(one.robot, len(robots)), one.robot, one.policy, engines.index(one.engine)

    return sorted(results, key=place)


def tables(results: Sequence[Result]) -> Group:
    """For each suite the table of engines and the right walks by skill; at most 80 columns wide."""
    shown = ordered(results)
    suites = list(dict.fromkeys((one.suite.name, one.suite.digest) for one in shown))
    parts = [[one for one in shown if (one.suite.name, one.suite.digest) == suite] for suite in suites]
    whole = (table for part in parts for table in _of_suite(part))
    return Group(*(narrow for one in whole for narrow in fitted(one, TABLE_WIDTH)), EXPLANATION)


def _of_suite(results: Sequence[Result]) -> list[Table]:
    stamp = results[0].suite
    engines = table(f"engines, suite {stamp.name} ({stamp.digest})", ("robot", "engine"), HEADINGS)
    for result in results:
        several = len({one.policy for one in results}) > 1
        engines.add_row(f"{result.robot}\n{result.policy}" if several else result.robot, result.engine, *_cells(result))
    return [engines, _by_skill(results), *_reasons(results)]


def markdown(results: Sequence[Result]) -> str:
    """The table of engines for a page."""
    rows = []
    for result in ordered(results):
        kind = ENGINES[result.engine]
        engine = f"{kind.title}, {kind.package} {result.version}, {1000 * result.timestep_s:g} ms"
        rows.append([result.robot, result.policy, engine, *_cells(result)])
    return pipe_table(["robot", "policy", "engine", *HEADINGS], rows) + "\n"


def _cells(result: Result) -> list[str]:
    found = figures(result.walks)
    return [
        str(len(result.walks)),
        " ".join(fraction_cells(found.right)),
        percent(found.label.value if found.label else None),
        str(found.falls),
        cell(found.frequency_ratio, ".3f"),
        cell(found.linear_error_m_s, ".3f"),
        cell(found.yaw_rate_error_rad_s, ".3f"),
    ]


def _by_skill(results: Sequence[Result]) -> Table:
    """Right walks of all walks, skill by skill."""
    found = table("right walks by skill", ("skill",), [_column(result, results) for result in results])
    for skill in skills_of(results):
        counts = []
        for result in results:
            walks = [walk for walk in result.walks if walk.skill == skill]
            counts.append(f"{sum(walk.right for walk in walks)}/{len(walks)}" if walks else "-")
        found.add_row(skill, *counts)
    return found


def _reasons(results: Sequence[Result]) -> list[Table]:
    """Upright walks that are not right, by the criteria that they fail; none where all are right."""
    counts = [Counter(name for walk in result.walks for name in walk.failed or ()) for result in results]
    criteria = list(dict.fromkeys(name for count in counts for name in count))
    if not criteria:
        return []
    found = table("upright walks that fail a criterion", ("criterion",), [_column(one, results) for one in results])
    for name in criteria:
        found.add_row(name, *(str(count[name] or "-") for count in counts))
    return [found]


def _column(result: Result, results: Sequence[Result]) -> str:
    """The engine, and where that does not tell results apart also robot or policy."""
    lines = [result.engine]
    lines += [result.robot] if len({one.robot for one in results}) > 1 else []
    lines += [result.policy] if len({one.policy for one in results}) > 1 else []
    return "\n".join(lines)
