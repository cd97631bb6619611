"""Running a function in several processes that form one world, on gloo."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
import torch.multiprocessing as mp

from camp import distributed


def in_ranks(work: Callable[[], Any], folder: Path, number: int = 2) -> list[Any]:
    """What ``work`` (a function of a module) returns on each of ``number`` ranks; through files in ``folder``."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    mp.spawn(_work, args=(work, folder, number, port), nprocs=number)  # type: ignore[attr-defined]
    return [torch.load(folder / f"{rank}.pt", weights_only=True) for rank in range(number)]


def _work(rank: int, work: Callable[[], Any], folder: Path, number: int, port: int) -> None:
    torch.set_num_threads(1)
    os.environ |= {
        "RANK": str(rank),
        "WORLD_SIZE": str(number),
        "LOCAL_RANK": str(rank),
        "LOCAL_WORLD_SIZE": str(number),
        "MASTER_ADDR": "127.0.0.1",
        "MASTER_PORT": str(port),
    }
    with distributed.join():
        torch.save(work(), folder / f"{rank}.pt")
