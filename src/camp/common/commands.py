"""Commands as messages show them: what is printed can be pasted into a shell."""

from __future__ import annotations

import shlex


def command(module: str, *arguments: str, **values: object) -> str:
    """``python -m module argument key=value``, quoted for the shell.

    >>> command("camp.evaluate", run="my runs/a", suite="short")
    "python -m camp.evaluate 'run=my runs/a' suite=short"
    """
    return shlex.join(["python", "-m", module, *arguments, *_pairs(values)])


def torchrun(ranks: int, module: str, **values: object) -> str:
    """The same in several processes.

    >>> torchrun(2, "camp.train", resume="outputs/a")
    'torchrun --nproc-per-node=2 -m camp.train resume=outputs/a'
    """
    return shlex.join(["torchrun", f"--nproc-per-node={ranks}", "-m", module, *_pairs(values)])


def _pairs(values: dict[str, object]) -> list[str]:
    return [f"{key}={value}" for key, value in values.items()]
