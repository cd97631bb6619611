"""The fault campaign: `python -m pytest tests/faults --kills 20`; docs/reliability.md shows its table."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.faults.nursery import Nursery
from tests.faults.victims import Count

COUNTS = pytest.StashKey[list[Count]]()


@pytest.fixture(scope="session")
def nursery() -> Iterator[Nursery]:
    """The process that forks the commands."""
    with Nursery() as started:
        yield started


@pytest.fixture
def kills(request: pytest.FixtureRequest) -> int:
    """How often each phase is killed."""
    return request.config.getoption("--kills")


@pytest.fixture
def campaign(request: pytest.FixtureRequest) -> None:
    """For what is too dear for the suite."""
    if request.config.getoption("--kills") < 5:
        pytest.skip("part of the campaign: python -m pytest tests/faults --kills 20")


@pytest.fixture
def count(request: pytest.FixtureRequest) -> Count:
    """The test's row of the campaign's table; its docstring is the promise."""
    counts = request.config.stash.setdefault(COUNTS, [])
    name = request.function.__name__.removeprefix("test_").replace("_", " ")
    counts.append(Count(name, " ".join((request.function.__doc__ or "").split())))
    return counts[-1]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """The table in Markdown, where one was asked for."""
    counts = config.stash.get(COUNTS, [])
    if not counts or config.getoption("--kills") < 5:
        return
    terminalreporter.write_line("\n| killed | kills | of these | what holds |\n|---|---|---|---|")
    for row in counts:
        notes = ", ".join(f"{number} {note}" for note, number in sorted(row.notes.items())) or "-"
        terminalreporter.write_line(f"| {row.phase} | {row.killed} | {notes} | {row.promise} |")
