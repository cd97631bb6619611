"""Work that takes longer than two seconds says what it does: a rewritten line on a terminal, sparse lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sized
from contextlib import contextmanager
from typing import Protocol, TextIO, TypeVar

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn

Item = TypeVar("Item")
LINES = 5  # of one phase besides its first, where the output is not a terminal


@contextmanager
def phase(what: str, total: int | None = None, stream: TextIO | None = None) -> Iterator[Callable[[], None]]:
    """Show that ``what`` is under way; call what is given after each of its ``total`` parts, if it has any.

    stream: stdout by default.
    """
    console = Console(file=stream or sys.stdout)
    if console.is_terminal:
        columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False))
        if total is not None:
            counted = TextColumn("{task.completed} of {task.total}")
            columns = (*columns, BarColumn(), counted, TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as bar:
            task = bar.add_task(what, total=total)
            yield lambda: bar.advance(task)
        return
    out, done = stream or sys.stdout, 0
    print(what if total is None else f"{what}: 0 of {total}", file=out, flush=True)

    def advance() -> None:
        nonlocal done
        done += 1
        if total is not None and done * LINES // total > (done - 1) * LINES // total:
            print(f"{what}: {done} of {total}", file=out, flush=True)

    yield advance


def track(items: Iterable[Item], what: str, total: int | None = None, stream: TextIO | None = None) -> Iterator[Item]:
    """The items, while `phase` shows how many are done. total: how many there are, where they do not know."""
    with phase(what, len(items) if isinstance(items, Sized) else total, stream) as advance:
        for item in items:
            yield item
            advance()


class Track(Protocol):
    """What shows how far work is: `track`, or `silently`."""

    def __call__(self, items: Iterable[Item], what: str) -> Iterable[Item]: ...


def silently(items: Iterable[Item], what: str) -> Iterable[Item]:
    """The items."""
    return items
