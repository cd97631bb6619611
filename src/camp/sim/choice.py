"""The choice of a simulator that can run on this machine."""

from __future__ import annotations

from importlib.util import find_spec

import torch

BACKENDS = ("cpu", "gpu")
AUTO = "auto"


def why_no_gpu(learner: str) -> str | None:
    """Why ``sim=auto`` does not choose the GPU simulator beside a learner on ``device=learner``; None where it does."""
    if learner == "cpu":
        return "device=cpu"
    if not torch.cuda.is_available():
        return "torch finds no CUDA GPU"
    if not warp_installed():
        return "mujoco_warp is not installed: pip install '.[gpu]'"
    return None


def warp_installed() -> bool:
    """Whether the packages of the GPU simulator are there; they take seconds to import."""
    return find_spec("mujoco_warp") is not None and find_spec("warp") is not None
