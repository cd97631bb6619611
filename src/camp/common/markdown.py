"""Pipe tables of Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def pipe_table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """The heading and the rows of as many cells, without a newline at the end."""
    return "\n".join([_row(heading), "|---" * len(heading) + "|", *map(_row, rows)])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
