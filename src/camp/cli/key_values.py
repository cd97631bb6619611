"""Command lines of a few ``key=value`` arguments that need no configuration."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence

from camp.cli.guard import guarded
from camp.common.errors import ConfigError


def run_command(task: Callable[[Sequence[str]], None], arguments: Sequence[str], usage: str | None) -> int:
    """Run ``task`` on the arguments, or print ``usage`` for --help; returns the exit code.

    How it ends: `guarded`.
    """
    if {"-h", "--help"} & set(arguments):
        print(usage)
        return 0

    def run() -> int:
        task(arguments)
        return 0

    return guarded(run)


def key_values(arguments: Sequence[str], required: Sequence[str], optional: Sequence[str] = ()) -> dict[str, str]:
    """The arguments by key, such as ``["run=outputs/latest"]`` -> ``{"run": "outputs/latest"}``.

    Raises ConfigError in one line for an unknown key, one without a value or given twice, and a missing one.
    """
    known = [*required, *optional]
    usage = " ".join([*(f"{key}=<value>" for key in required), *(f"[{key}=<value>]" for key in optional)])
    found: dict[str, str] = {}
    for argument in arguments:
        key, _, value = argument.partition("=")
        if key not in known:
            close = difflib.get_close_matches(key, known, n=1)
            raise ConfigError(f"argument {argument!r}: {f'did you mean {close[0]}=? ' if close else ''}give {usage}")
        if not value or key in found:
            raise ConfigError(f"argument {argument!r}: give {key}=<value>, once")
        found[key] = value
    missing = [key for key in required if key not in found]
    if missing:
        raise ConfigError(f"argument {missing[0]}=<value> is missing: give {usage}")
    return found
