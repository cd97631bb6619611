"""Ranks: processes that train one policy together, each on its share of the robots.

torchrun starts them and sets RANK, WORLD_SIZE, LOCAL_RANK and LOCAL_WORLD_SIZE. Without it there is a world of one, in
which every function gives back what it was given, so that callers need not ask. What moves data between ranks is
called by all of them in the same order; such functions raise RankError where another rank is gone.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from typing import Any, TypeVar

import torch
import torch.distributed as dist

# torch imports this one lazily. After `join`, the defaults of its functions would hold the group beyond
# `destroy_process_group`, and its threads would live into the interpreter's end, where they can abort the process.
import torch.distributed.nn
from torch import Tensor, nn

from camp.common.errors import ConfigError, RankError
from camp.common.tensors import copied

# Others wait while the first rank makes perturbed clips and imitates; a rank that dies is noticed at once.
PATIENCE = timedelta(hours=2)

Result = TypeVar("Result")

_alone = False  # inside `on_first`


@contextmanager
def join() -> Iterator[None]:
    """Meet the other ranks that torchrun has started, and part in the end. Raises RankError."""
    if _environment("WORLD_SIZE", 1) == 1:
        yield
        return
    if torch.cuda.is_available():
        torch.cuda.set_device(_environment("LOCAL_RANK", 0) % torch.cuda.device_count())
    # Two backends: what lies on the CPU (a checkpoint's parts, the gait monitor) never passes through a GPU.
    with _lost_others():
        dist.init_process_group("cpu:gloo,cuda:nccl" if torch.cuda.is_available() else "gloo", timeout=PATIENCE)
    try:
        yield
    except Exception:
        raise  # without parting, which would wait for ranks that wait for this one
    except BaseException:  # Ctrl-C: all stop after the same iteration
        dist.destroy_process_group()
        raise
    else:
        dist.destroy_process_group()


def size() -> int:
    """Number of ranks."""
    return 1 if _alone or not dist.is_initialized() else dist.get_world_size()


def rank() -> int:
    """This process's number, 0 to size - 1."""
    return dist.get_rank() if dist.is_initialized() else 0


def is_first() -> bool:
    """Whether this rank is the one that prints, logs and saves."""
    return rank() == 0


def local_rank() -> int:
    """This process's number on its machine."""
    return _environment("LOCAL_RANK", 0)


def local_size() -> int:
    """Number of ranks on this machine."""
    return _environment("LOCAL_WORLD_SIZE", 1)


def label() -> str:
    """What begins an error's line: 'rank 1: ' among several ranks, nothing in a world of one."""
    return f"rank {_environment('RANK', 0)}: " if _environment("WORLD_SIZE", 1) > 1 else ""


def announce(text: str) -> None:
    """Print on the first rank."""
    if is_first():
        print(text, flush=True)


def stream(name: str) -> str:
    """The name of this rank's own random stream; the first rank's is that of a world of one."""
    return name if is_first() else f"{name}, rank {rank()}"


def share(key: str, value: int) -> int:
    """This rank's part of a configured total. Raises ConfigError where the ranks cannot share it equally."""
    if value % size():
        raise ConfigError(f"{key} = {value}: the {size()} processes share it equally; choose a multiple of {size()}")
    return value // size()


def total(value: Tensor) -> Tensor:
    """The sum of all ranks' values, on every rank; any shape."""
    if size() == 1:
        return value
    summed = value.detach().clone()
    with _lost_others():
        dist.all_reduce(summed)
    return summed


def average(value: Tensor) -> Tensor:
    """The mean of all ranks' values, on every rank; any shape."""
    return total(value) / size()


def anywhere(flag: bool) -> bool:
    """Whether the flag is set on any rank."""
    return bool(total(torch.tensor(int(flag))))


def moments(rows: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Mean (D,), population variance (D,) and number () of all ranks' rows (M, D), in float64; zeros without rows."""
    rows = rows.to(torch.float64)
    number = rows.shape[0]
    if number:
        variance, mean = torch.var_mean(rows, dim=0, correction=0)
    else:
        variance, mean = rows.new_zeros(2, rows.shape[1])
    sums = total(torch.cat([number * mean, mean.new_tensor([number])]))
    count = sums[-1]
    all_mean = sums[:-1] / count.clamp(min=1.0)
    spread = total(number * (variance + (mean - all_mean).square()))
    return all_mean, spread / count.clamp(min=1.0), count


def average_gradients(parameters: Iterable[nn.Parameter]) -> None:
    """Give every rank the mean of all ranks' gradients; all must be there."""
    gradients = [parameter.grad for parameter in parameters if parameter.grad is not None]
    if size() == 1 or not gradients:
        return
    mean = average(torch.cat([gradient.flatten() for gradient in gradients]))  # one message, not one per layer
    for gradient, part in zip(gradients, mean.split([g.numel() for g in gradients]), strict=True):
        gradient.copy_(part.view_as(gradient))


def copy_from_first(modules: Iterable[nn.Module]) -> None:
    """Give every rank the first one's parameters and buffers."""
    if size() == 1:
        return
    with _lost_others():
        for module in modules:
            for tensor in module.state_dict(keep_vars=False).values():
                dist.broadcast(tensor, src=0)


def on_first(make: Callable[[], Result]) -> Result:
    """What `make` returns on the first rank, on every rank (pickled); inside it the world is one."""
    global _alone
    if size() == 1:
        return make()
    made: list[Any] = [None]
    if is_first():
        _alone = True
        try:
            made = [make()]
        finally:
            _alone = False
    with _lost_others():
        dist.broadcast_object_list(made, src=0)
    return made[0]


def gather(state: Any) -> list[Any]:
    """Every rank's state (nested dicts, lists and tuples of tensors and plain values), on the first rank and on the
    CPU; an empty list on the others."""
    if size() == 1:
        return [state]
    gathered: list[Any] | None = [None] * size() if is_first() else None
    with _lost_others():
        dist.gather_object(copied(state, "cpu"), gathered, dst=0)
    return gathered or []


def _environment(name: str, default: int) -> int:
    return int(os.environ.get(name, default))


@contextmanager
def _lost_others() -> Iterator[None]:
    try:
        yield
    except RuntimeError as error:  # gloo, nccl and the store that they meet in
        reason = (str(error).strip().splitlines() or [type(error).__name__])[0]
        raise RankError(
            f"the other processes cannot be reached ({reason}); the first error of another rank tells why, "
            "or else check that all were started with the same --nnodes and --rdzv-endpoint"
        ) from error
