"""The quality of a set of clips as a table: per clip for the terminal, worst values per cell for the card."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import SPLITS, STAND, Clip
from camp.motion.clips.consistency import ClipCheck

Cell = tuple[str, str, float]  # split, gait, stride frequency in Hz
_COLUMN_WIDTH = 10  # characters of a criterion where all are shown


def failure_table(results: Mapping[str, Sequence[ClipCheck]]) -> Table:
    """One row per criterion that a clip misses."""
    table = _narrow("what fails", "clip", "criterion", "value", "limit")
    for clip, checks in results.items():
        for check in checks:
            if not check.passed:
                table.add_row(clip, check.name, _cell(check), _limit(check))
    return table


def worst_table(results: Mapping[str, Sequence[ClipCheck]]) -> Table:
    """Each criterion's worst value and the clip that has it, failures first."""
    worst: dict[str, tuple[ClipCheck, str]] = {}
    for clip, checks in results.items():
        for check in checks:
            if check.name not in worst or _badness(check) > _badness(worst[check.name][0]):
                worst[check.name] = check, clip
    table = _narrow("worst of each criterion", "criterion", "clip", "value", "limit")
    for check, clip in sorted(worst.values(), key=lambda found: found[0].passed):
        table.add_row(check.name, clip, _cell(check), _limit(check))
    return table


def quality_tables(results: Mapping[str, Sequence[ClipCheck]], width: int) -> list[Table]:
    """Every clip with every criterion, failing clips first, in as many tables as `width` characters ask for.

    Failures are red. Criteria that are stricter for some clips show the strictest limit.
    """
    columns = list(_by_name(results.values()).items())
    room = width - max(map(len, results), default=0) - 2
    at_once = max(1, room // (_COLUMN_WIDTH + 2))
    return [_block(results, dict(columns[first : first + at_once])) for first in range(0, len(columns), at_once)]


def _block(results: Mapping[str, Sequence[ClipCheck]], columns: Mapping[str, list[ClipCheck]]) -> Table:
    table = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 1))
    table.add_column("clip", no_wrap=True)
    for name, checks in columns.items():
        strict = min(checks, key=_looseness)
        table.add_column(f"{name} {_limit(strict)}", justify="right", width=_COLUMN_WIDTH)
    order = sorted(results, key=lambda clip: all(check.passed for check in results[clip]))
    for clip in order:
        by_name = {check.name: check for check in results[clip]}
        table.add_row(clip, *(_cell(by_name[name]) if name in by_name else "-" for name in columns))
    return table


def _narrow(title: str, *names: str) -> Table:
    """A table that fits 80 columns."""
    table = Table(title=title, box=SIMPLE_HEAD, title_justify="left", padding=(0, 1, 0, 0), pad_edge=False)
    for name in names:
        table.add_column(name, justify="right" if name == "value" else "left", overflow="fold")
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


def _limit(check: ClipCheck) -> str:
    return f"{check.bound} {check.limit:.3g}"


def _cell(check: ClipCheck) -> Text:
    return Text(f"{check.value:.3f}", style="" if check.passed else "bold red")
