"""Cells and frames of the printed tables."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console
from rich.table import Column, Table

from camp.evaluation.report import Estimate

Part = TypeVar("Part")
TABLE_WIDTH = 80  # characters, where the output is not a terminal
MARGIN = 2  # characters of a column besides its cells: a blank and the gap to the next


def table_console() -> Console:
    """Where tables are printed."""
    return Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)


def fitted(whole: Table, width: int) -> list[Table]:
    """A table as one or more of at most ``width`` characters, each with its columns of text and some of the figures."""
    text = [column for column in whole.columns if column.justify != "right"]
    figures = [column for column in whole.columns if column.justify == "right"]
    room = width - MARGIN - sum(_width(column) for column in text)
    blocks: list[list[Column]] = [[]]
    for column in figures:
        if blocks[-1] and sum(map(_width, blocks[-1])) + _width(column) > room:
            blocks.append([])
        blocks[-1].append(column)
    result = []
    for number, block in enumerate(blocks):
        part = table(f"{whole.title}{' (further columns)' * (number > 0)}", (), ())
        for column in (*text, *block):
            part.add_column(column.header, justify=column.justify, no_wrap=_width(column) <= room)
        for row, cells in zip(whole.rows, zip(*(c.cells for c in (*text, *block)), strict=True), strict=True):
            part.add_row(*cells, end_section=row.end_section)
        result.append(part)
    return result


def worst_first(
    parts: Mapping[str, Part], value: Callable[[Part], float | None], most: int | None = None
) -> dict[str, Part]:
    """The parts by name in the order of a value, smallest first and absent last; at most so many."""
    order = sorted(parts, key=lambda name: _or_last(value(parts[name])))
    return {name: parts[name] for name in order[:most]}


def of_estimate(found: Estimate | None) -> float | None:
    """Its value."""
    return None if found is None else found.value


def _or_last(value: float | None) -> float:
    return math.inf if value is None else value


def _width(column: Column) -> int:
    texts = (column.header, *column.cells)
    return MARGIN + max((cell_len(line) for text in texts for line in str(text).splitlines()), default=0)


def table(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    """An empty table; columns of ``left`` hold text, those of ``right`` figures."""
    result = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
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
