"""Random numbers from one seed: independent named streams, and their states for checkpoints.

Every stream (environment, policy, minibatches, ...) has its own generator, so that drawing more numbers in
one place, as an ablation does, changes nothing anywhere else.
"""

from __future__ import annotations

import hashlib
import random
from typing import Any

import numpy as np
import torch
from torch import Tensor


def seed_everything(seed: int) -> None:
    """Seed the global generators of Python, NumPy and torch (all devices).

    camp draws from named streams only; libraries do not. Raises ValueError for a seed below 0.
    """
    if seed < 0:
        raise ValueError(f"seed {seed}: must be 0 or more")
    random.seed(seed)
    np.random.seed(seed % 2**32)
    torch.manual_seed(seed)


def generator(seed: int, stream: str, device: torch.device | str = "cpu") -> torch.Generator:
    """A torch generator that depends on `seed` and the stream's name alone."""
    # sha256, because Python's own hash of a string differs from process to process.
    digest = np.frombuffer(hashlib.sha256(stream.encode()).digest(), dtype="<u4")
    sequence = np.random.SeedSequence([seed, *(int(word) for word in digest)])
    # torch's CPU generator uses the lower 32 bits of a seed, so give it no more.
    word = int(sequence.generate_state(1)[0])
    return torch.Generator(device=device).manual_seed(word)


def generator_state(source: torch.Generator) -> Tensor:
    """The generator's state in a form `save_checkpoint` accepts."""
    return source.get_state()


def restore_generator(target: torch.Generator, state: Tensor) -> None:
    """Put `target` back into a state from `generator_state`."""
    target.set_state(_host(state))


def global_state() -> dict[str, Any]:
    """The states of the global generators, in a form `save_checkpoint` accepts."""
    name, keys, position, has_gauss, cached = np.random.get_state(legacy=True)
    return {
        "python": random.getstate(),
        "numpy": (name, torch.from_numpy(np.asarray(keys).astype(np.int64)), position, has_gauss, cached),
        "torch": torch.get_rng_state(),
        "cuda": torch.cuda.get_rng_state_all() if torch.cuda.is_available() else [],
    }


def restore_global_state(state: dict[str, Any]) -> None:
    """Put the global generators back into a state from `global_state`."""
    random.setstate(state["python"])
    name, keys, position, has_gauss, cached = state["numpy"]
    np.random.set_state((name, keys.numpy().astype(np.uint32), position, has_gauss, cached))
    torch.set_rng_state(_host(state["torch"]))
    if state["cuda"]:
        torch.cuda.set_rng_state_all([_host(one) for one in state["cuda"]])


def _host(state: Tensor) -> Tensor:
    """A checkpoint loaded onto a GPU carries its generator states along; torch wants them on the CPU."""
    return state.cpu()
