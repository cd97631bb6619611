"""A curriculum of conditions: harder once the gaits hold, easier where they are lost."""

from __future__ import annotations

from collections.abc import Mapping

from camp.envs.config import HardeningConfig


def next_difficulty(difficulty: float, metrics: Mapping[str, object], config: HardeningConfig) -> float:
    """The difficulty in [0, 1] after an iteration's metrics.

    Moved by the readings of ``run.gait_every``, which come from foot contacts and not from a discriminator: up where
    the mean over skills shows its gait and few robots fall, down where the gaits are being lost. Between two
    readings, and without any, it stays.
    """
    accuracy = _mean_accuracy(metrics)
    falls = metrics.get("env/falls_per_1000_steps")
    if config.initial is None or accuracy is None or not isinstance(falls, float):
        return difficulty
    if accuracy >= config.accuracy_up and falls <= config.falls_per_1000_steps:
        return min(1.0, difficulty + config.step)
    if accuracy < config.accuracy_down:
        return max(0.0, difficulty - config.step)
    return difficulty


def _mean_accuracy(metrics: Mapping[str, object]) -> float | None:
    """Of the skills that robots followed long enough to be read; None where there are none."""
    names = [name for name in metrics if name.startswith("gait/") and name.endswith("/accuracy")]
    values = [value for name in names if isinstance(value := metrics[name], float)]
    return sum(values) / len(values) if values else None
