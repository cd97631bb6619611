"""The batched environment of the tests: eight robots whose episodes begin together."""

from __future__ import annotations

import torch

from camp.build import build_env
from camp.config.schema import Config
from camp.envs.quadruped import QuadrupedEnv
from camp.motion.clips.clip import Clip

ZERO = torch.zeros(8, 12)


def make(config: Config, clips: list[Clip]) -> QuadrupedEnv:
    env = build_env(config, clips)
    env.reset(seed=0, options={"stagger": False})
    return env
