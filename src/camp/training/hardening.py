"""A curriculum of conditions: harder once the gaits hold, easier where they are lost."""

from __future__ import annotations

from collections.abc import Mapping

from camp.envs.config import HardeningConfig
from camp.training.gait_monitor import accuracies


def next_difficulty(
    difficulty: float, metrics: Mapping[str, object], config: HardeningConfig, num_skills: int
) -> float:
    """The difficulty in [0, 1] after an iteration's metrics.

    Moved by the readings of ``run.gait_every``, which come from foot contacts and not from a discriminator: up where
    enough robots show their gait, of all skills and of each, and few fall; down where the gaits are being lost. Between
    two readings, and without any, it stays.
    """
    read = accuracies(metrics, num_skills)
    falls = metrics.get("env/falls_per_1000_steps")
    if config.initial is None or not read or not isinstance(falls, float):
        return difficulty
    mean = sum(read) / len(read)
    holds = mean >= config.accuracy_up and min(read) >= config.weakest_up
    if holds and falls <= config.falls_per_1000_steps:
        return min(1.0, difficulty + config.step)
    if mean < config.accuracy_down:
        return max(0.0, difficulty - config.step)
    return difficulty
