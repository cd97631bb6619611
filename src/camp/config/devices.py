"""The devices of learner and simulator."""

from __future__ import annotations

import torch

from camp.common import checks, distributed
from camp.common.errors import ConfigError
from camp.config.schema import Config


def learner_device(name: str) -> torch.device:
    """The torch device behind ``device``; auto takes a CUDA GPU where there is one, several ranks on one machine take
    one each. Raises ConfigError."""
    automatic = "cuda" if torch.cuda.is_available() else "cpu"
    try:
        device = torch.device(automatic if name == "auto" else name)
    except RuntimeError as error:
        raise ConfigError(f"device = {name!r}: choose auto, cpu, cuda or cuda:<number>") from error
    if device.type == "cuda" and distributed.local_size() > 1:
        checks.require(device.index is None, "device", name, "torchrun gives each process its own GPU; choose cuda")
        device = torch.device("cuda", distributed.local_rank())
    found = torch.cuda.device_count()
    if device.type == "cuda" and (device.index or 0) >= found:
        raise ConfigError(f"device = {name!r}: torch finds {found} CUDA GPUs here and not {device}; choose cpu or auto")
    return device


def simulator_device(config: Config) -> torch.device:
    """Where the simulator's tensors are: the CPU, or the learner's GPU. Raises ConfigError."""
    if config.sim.device == "cpu":
        return torch.device("cpu")
    if not torch.cuda.is_available():
        raise ConfigError("sim.device = 'cuda': torch finds no CUDA GPU here; choose sim=cpu")
    learner = learner_device(config.device)
    if learner.type != "cuda":
        raise ConfigError(
            f"device = {config.device!r} beside sim=gpu: the learner would wait for copies at every step; "
            "choose device=cuda, or sim=cpu"
        )
    return torch.device("cuda", torch.cuda.current_device() if learner.index is None else learner.index)
