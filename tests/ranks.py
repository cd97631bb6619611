"""Running a function in several processes that form one world, on gloo."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from torch.distributed.launcher.api import LaunchConfig, elastic_launch

from camp.common import distributed


def in_ranks(work: Callable[[], Any], folder: Path, number: int = 2) -> list[Any]:
    """What ``work`` (a function of a module) returns on each of ``number`` ranks; through files in ``folder``."""
    # As `torchrun --standalone` does it: port 0 is a free one, held from the moment it is chosen.
    launch = LaunchConfig(
        1, 1, number, run_id=folder.name, rdzv_backend="c10d", rdzv_endpoint="localhost:0", max_restarts=0
    )
    elastic_launch(launch, _work)(work, folder)
    return [torch.load(folder / f"{rank}.pt", weights_only=True) for rank in range(number)]


def _work(work: Callable[[], Any], folder: Path) -> None:
    torch.set_num_threads(1)
    with distributed.join():
        torch.save(work(), folder / f"{distributed.rank()}.pt")
    left = [name for name in _threads() if "gloo" in name]
    assert not left, f"threads of the process group outlive it, and may abort the process at its end: {left}"


def _threads() -> list[str]:
    """Names of this process's threads; none where the system does not tell."""
    return [comm.read_text().strip() for comm in Path("/proc/self/task").glob("*/comm")]
