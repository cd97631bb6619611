"""What a command says of bad input."""

from __future__ import annotations


def assert_one_line(stderr: str, message: str = "") -> None:
    """One line, marked as an error, that holds ``message``."""
    assert stderr.startswith("error: ") and message in stderr and stderr.count("\n") == 1
