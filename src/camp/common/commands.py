"""Commands as messages show them: what is printed can be pasted into a shell."""

from __future__ import annotations

import shlex


def command(module: str, *arguments: str, **values: object) -> str:
    """``python -m module argument key=value``, quoted for the shell.

    >>> command("camp.evaluate", run="my runs/a", suite="short")
    "python -m camp.evaluate 'run=my runs/a' suite=short"
    """
    return shlex.join(["python", "-m", module, *arguments, *(f"{key}={value}" for key, value in values.items())])
