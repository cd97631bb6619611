"""How near the networks' updates come to what a matrix product reaches on the same machine."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import torch
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils.flop_counter import flop_registry

from camp.training.runner import Runner

SIZE = 2048  # rows and columns of the two matrices
ROUNDS = 5  # updates and products in turn, so that a drifting machine slows both alike


class Operations(TorchDispatchMode):
    """Counts the floating-point operations of matrix products, a multiplication and an addition as two.

    ``FlopCounterMode`` of torch counts the same, but refuses the gradient penalty's gradient of a gradient.
    """

    def __init__(self) -> None:
        super().__init__()
        self.total = 0

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        result = func(*args, **(kwargs or {}))
        if func.overloadpacket in flop_registry:
            self.total += flop_registry[func.overloadpacket](*args, **(kwargs or {}), out_val=result)
        return result


class Meter:
    """Watches methods of an iteration: the time that they take, or the operations."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self.operations = 0
        self.counting = False  # takes time itself, so an iteration is either counted or timed

    def watch(self, owner: Any, name: str) -> None:
        """From now on, count or time each call of ``owner.name``."""
        method = getattr(owner, name)

        def watched(*args: Any, **kwargs: Any) -> Any:
            counter = Operations() if self.counting else None
            context: AbstractContextManager[Any] = counter or nullcontext()
            started = time.perf_counter()
            with context:
                result = method(*args, **kwargs)
            self.seconds += time.perf_counter() - started
            self.operations += counter.total if counter else 0
            return result

        setattr(owner, name, watched)


def rates(runner: Runner) -> dict[str, float]:
    """Operations per s of PPO's update, of the priors' updates, and of a matrix product in the same precision.

    On the CPU alone: a GPU would have to be waited for after every call.
    """
    training = runner.training
    meters = {"PPO's update": Meter(), "priors' updates": Meter()}
    meters["PPO's update"].watch(training.ppo, "update")
    for prior in training.priors:
        meters["priors' updates"].watch(prior, "update")
    for meter in meters.values():
        meter.counting = True
    runner.iterate()
    found: dict[str, list[float]] = {name: [] for name in (*meters, "matrix product")}
    product = _product(torch.bfloat16 if runner.config.algo.precision == "bfloat16" else torch.float32)
    for _ in range(ROUNDS):
        for meter in meters.values():
            meter.counting, meter.seconds = False, 0.0
        runner.iterate()
        for name, meter in meters.items():
            found[name].append(meter.operations / meter.seconds)
        found["matrix product"].append(product())
    return {name: statistics.median(values) for name, values in found.items()}


def _product(dtype: torch.dtype) -> Callable[[], float]:
    """A measurement of the product's operations per s."""
    left, right = torch.rand(SIZE, SIZE, dtype=dtype), torch.rand(SIZE, SIZE, dtype=dtype)
    torch.mm(left, right)  # warms up

    def measured() -> float:
        started = time.perf_counter()
        torch.mm(left, right)
        return 2.0 * SIZE**3 / (time.perf_counter() - started)

    return measured
