"""The number of threads of this process, so that torch, the simulator and other processes do not compete."""

from __future__ import annotations

import os

import torch

from camp.common import distributed


def threads_of_process(threads: int) -> int:
    """Threads for torch and for the simulator each (they take turns); 0: one per processor to both.

    A configured number counts as it is, for each process. Ranks on one machine share its processors. Whoever else
    starts several processes, as a launcher of sweeps does, bounds them with OMP_NUM_THREADS.
    """
    if threads > 0:
        return threads
    if distributed.local_size() > 1:  # torchrun sets OMP_NUM_THREADS to 1 then, however many processors there are
        return max(1, _processors() // distributed.local_size())
    bound = os.environ.get("OMP_NUM_THREADS", "")
    return int(bound) if bound.isdigit() else 0


def set_threads(threads: int) -> None:
    """Give torch's operations ``threads_of_process``."""
    share = threads_of_process(threads)
    if share > 0:
        torch.set_num_threads(share)


def _processors() -> int:
    """Those that this process may run on, fewer than the machine's under Slurm or in a container."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
