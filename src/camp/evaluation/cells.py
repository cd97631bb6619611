"""Cells and frames of the printed tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.table import Table

from camp.evaluation.report import Estimate


def table(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    """An empty table; columns of ``left`` hold text, those of ``right`` figures."""
    result = Table(title=title, title_justify="left")
    for heading in left:
        result.add_column(heading)
    for heading in right:
        result.add_column(heading, justify="right")
    return result


def percent(value: float | None) -> str:
    """Whole percent, rounded down: 100 % is what has no exception."""
    return "-" if value is None else f"{math.floor(100.0 * value + 1e-9)}%"


def fraction_cells(found: Estimate | None) -> tuple[str, str]:
    """A fraction and its interval."""
    if found is None:
        return "-", "-"
    return percent(found.value), f"{100 * found.low:.0f}-{100 * found.high:.0f}"


def cell(value: float | None, form: str) -> str:
    """A figure, or a dash."""
    return "-" if value is None else format(value, form)
