"""Conditions under which training no longer learns, and what helps against each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from camp.config import Config

Metrics = Mapping[str, float]


@dataclass(frozen=True)
class Alarm:
    """A condition on one iteration's metrics that means trouble once it has held for ``patience`` of them."""

    name: str
    holds: Callable[[Metrics], bool]
    patience: int  # iterations
    remedy: str


def alarms_of(config: Config) -> list[Alarm]:
    """What can go wrong with this configuration. Measured examples: docs/training.md."""
    largest_kl = 3.0 * config.algo.ppo.desired_kl
    return [
        Alarm(
            "style_saturated",
            lambda m: m.get("prior/style/accuracy", 0.0) > 0.97 and m.get("reward/style/raw", 1.0) < 0.1,
            20,
            "the style discriminator is always right and rewards nothing: fewer algo.style.updates, a lower "
            "algo.style.learning_rate, algo.style.input_noise=0.1 or algo.style.replay_size=100000",
        ),
        Alarm(
            "style_blind",
            lambda m: m.get("prior/style/accuracy", 1.0) < 0.55,
            50,
            "the style discriminator tells nothing apart: unless the policy moves as the expert does, more "
            "algo.style.updates, a higher algo.style.learning_rate or a lower algo.style.gradient_penalty",
        ),
        Alarm(
            "skills_merged",
            lambda m: m.get("prior/style/embedding_similarity", 0.0) > 0.9,
            20,
            "two skills have nearly the same embedding: more algo.style.mismatch_share (0.5 in run=quick) or a lower "
            "algo.style.learning_rate",
        ),
        Alarm(
            "skill_blind",
            lambda m: m.get("prior/skill/accuracy", 1.0) < 0.5,
            100,
            "the skill discriminator does not know the expert's skills: more algo.skill.updates or a lower "
            "algo.skill.gradient_penalty",
        ),
        Alarm(
            "policy_too_fast",
            lambda m: m.get("ppo/kl", 0.0) > largest_kl,
            20,
            "the policy moves several times algo.ppo.desired_kl an iteration: a lower algo.ppo.min_learning_rate, "
            "fewer algo.ppo.epochs",
        ),
    ]


class AlarmMonitor:
    """Counts for how many iterations on end each condition has held."""

    def __init__(self, alarms: list[Alarm]) -> None:
        self.alarms = alarms
        self._held = {alarm.name: 0 for alarm in alarms}

    def update(self, metrics: Metrics) -> dict[str, float]:
        """Take in one iteration; ``alarm/<name>`` for each alarm, 1 while it rings and else 0."""
        for alarm in self.alarms:
            self._held[alarm.name] = self._held[alarm.name] + 1 if alarm.holds(metrics) else 0
        return {f"alarm/{alarm.name}": float(self._held[alarm.name] >= alarm.patience) for alarm in self.alarms}

    def new(self) -> list[str]:
        """A line for each alarm that the last iteration set off."""
        return [
            f"alarm {alarm.name}, for {alarm.patience} iterations: {alarm.remedy}"
            for alarm in self.alarms
            if self._held[alarm.name] == alarm.patience
        ]

    def state_dict(self) -> dict[str, int]:
        return dict(self._held)

    def load_state_dict(self, state: dict[str, int]) -> None:
        self._held |= state
