"""Reading what others made: whatever a library raises on such a file is the file's fault, told in one line."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import yaml

from camp.common.errors import CampError

if TYPE_CHECKING:
    from pydantic import ValidationError

LARGEST_BYTES = 2**28  # of a file, and of what it unpacks to: an hour of motion in any format takes less
LARGEST_YAML = 2**20  # bytes; a configuration has 5000, and reading a MiB takes seconds
DEEPEST = 64  # levels of a YAML; a configuration has five
MOST_DIGITS = 18  # of a whole number


@contextmanager
def foreign_file(
    path: Path, what: str, remedy: str, error: type[CampError], largest: float = LARGEST_BYTES
) -> Iterator[None]:
    """Turn whatever reading raises into one `error`: "`what` (the reason); `remedy`".

    Lists of exceptions miss some: parsers of damaged files raise RecursionError, OverflowError, MemoryError and their
    own. Keep what stands inside to the reading itself. Files of more than `largest` bytes are refused unread.
    """
    try:
        size = path.stat().st_size
        if size > largest:
            raise ValueError(f"{size / 2**20:.0f} MiB, at most {largest / 2**20:.0f} are read")
        yield
    except CampError:
        raise
    except Exception as reason:
        raise error(f"{what} ({first_line(reason)})" + (f"; {remedy}" if remedy else "")) from reason


def first_line(reason: Exception) -> str:
    """What an exception says, as one line."""
    text = reason.strerror if isinstance(reason, OSError) and reason.strerror else str(reason)
    return " ".join((text.splitlines() or [""])[0].split()) or type(reason).__name__


def read_json(text: str | bytes) -> Any:
    """What a JSON text holds, its numbers all finite. Raises ValueError, also for one that is nested without end."""
    try:
        return json.loads(text, parse_constant=_no_number, parse_float=_finite, parse_int=_whole)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error


def check_yaml(text: str) -> None:
    """Raise ValueError for a YAML that is no plain tree: one that repeats itself by aliases, or is nested too deeply.

    Both are a few bytes that take all memory or the whole stack once they are built.
    """
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        if isinstance(event, yaml.AliasEvent):
            raise ValueError(f"holds the alias *{event.anchor}")
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            raise ValueError(f"nested deeper than {DEEPEST} levels")


def _no_number(text: str) -> NoReturn:
    raise ValueError(f"holds {text}, which is no number")


def _finite(text: str) -> float:
    value = float(text)
    return value if math.isfinite(value) else _no_number(text[:20])


def _whole(text: str) -> int:
    return int(text) if len(text) <= MOST_DIGITS else _no_number(f"{text[:MOST_DIGITS]}...")


def first_problem(error: ValidationError, whole: str = "") -> str:
    """The first of pydantic's complaints as one line: where, and what; ``whole`` is where it is about everything."""
    first = error.errors(include_url=False)[0]
    where = ".".join(str(part) for part in first["loc"]) or whole
    what = first["msg"].removeprefix("Value error, ")
    return f"{where}: {what}" if where else what
