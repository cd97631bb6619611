"""The quality of a set of clips as a table: per clip for the terminal, worst values per cell for the card."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rich.table import Table
from rich.text import Text

from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import SPLITS, STAND, Clip
from camp.motion.clips.consistency import ClipCheck

Cell = tuple[str, str, float]  # split, gait, stride frequency in Hz


def quality_table(results: Mapping[str, Sequence[ClipCheck]]) -> Table:
    """One row per clip, one column per criterion, failures in red, each column's worst value at the foot.

    Criteria that are stricter for some clips show the strictest limit.
    """
    table = Table(show_footer=True)
    table.add_column("clip", footer="worst", no_wrap=True)
    columns = _by_name(results.values())
    for name, checks in columns.items():
        worst, strict = max(checks, key=_badness), min(checks, key=_looseness)
        table.add_column(f"{name}\n{worst.bound} {strict.limit:.3g}", footer=_cell(worst), justify="right")
    for clip, checks in results.items():
        by_name = {check.name: check for check in checks}
        table.add_row(clip, *(_cell(by_name[name]) if name in by_name else "-" for name in columns))
    return table


def worst_by_cell(
    clips: Mapping[str, Clip], results: Mapping[str, Sequence[ClipCheck]]
) -> dict[Cell, dict[str, ClipCheck]]:
    """Each criterion's worst check among the clips of every split, gait and frequency, in that order."""
    groups: dict[Cell, list[Sequence[ClipCheck]]] = {}
    gaits = [*GAIT_PHASES, STAND]
    for name in sorted(clips, key=lambda name: _order(clips[name], gaits)):
        clip = clips[name]
        groups.setdefault((clip.split, clip.gait, clip.frequency_hz), []).append(results[name])
    return {
        cell: {name: max(checks, key=_badness) for name, checks in _by_name(group).items()}
        for cell, group in groups.items()
    }


def _order(clip: Clip, gaits: list[str]) -> tuple[int, int, float]:
    return SPLITS.index(clip.split), gaits.index(clip.gait), clip.frequency_hz


def _by_name(results: Iterable[Sequence[ClipCheck]]) -> dict[str, list[ClipCheck]]:
    columns: dict[str, list[ClipCheck]] = {}
    for checks in results:
        for check in checks:
            columns.setdefault(check.name, []).append(check)
    return columns


def _badness(check: ClipCheck) -> float:
    return check.value if check.bound == "<=" else -check.value


def _looseness(check: ClipCheck) -> float:
    return check.limit if check.bound == "<=" else -check.limit


def _cell(check: ClipCheck) -> Text:
    return Text(f"{check.value:.3f}", style="" if check.passed else "bold red")
