"""The quality of a set of clips as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.table import Table
from rich.text import Text

from camp.motion.validate import ClipCheck


def quality_table(results: Mapping[str, Sequence[ClipCheck]]) -> Table:
    """One row per clip, one column per criterion, failures in red, each column's worst value at the foot."""
    columns: dict[str, list[ClipCheck]] = {}
    for checks in results.values():
        for check in checks:
            columns.setdefault(check.name, []).append(check)
    table = Table(show_footer=True)
    table.add_column("clip", footer="worst", no_wrap=True)
    for name, checks in columns.items():
        worst = max(checks, key=_badness)
        table.add_column(f"{name}\n{worst.bound} {worst.limit:.3g}", footer=_cell(worst), justify="right")
    for clip, checks in results.items():
        by_name = {check.name: check for check in checks}
        table.add_row(clip, *(_cell(by_name[name]) if name in by_name else "-" for name in columns))
    return table


def _badness(check: ClipCheck) -> float:
    return check.value if check.bound == "<=" else -check.value


def _cell(check: ClipCheck) -> Text:
    return Text(f"{check.value:.3f}", style="" if check.passed else "bold red")
