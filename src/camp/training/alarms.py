"""Alarms: conditions under which training no longer makes progress, each with its remedy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite

from camp.config.schema import Config

Metrics = Mapping[str, float]
NAMED = 4  # metrics in one line at most


@dataclass(frozen=True)
class Alarm:
    """A condition on one iteration's metrics that means trouble once it has held for ``patience`` of them."""

    name: str
    holds: Callable[[Metrics], bool]
    patience: int  # iterations
    remedy: str
    culprits: Callable[[Metrics], list[str]] = lambda metrics: []  # keys to name, where the condition has any


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
            "two skills have nearly the same embedding: more algo.style.mismatch_fraction (0.5 in run=quick) or a "
            "lower algo.style.learning_rate",
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
        Alarm(
            "diverged",
            lambda m: m.get("env/diverged_per_1000_steps", 0.0) > 0.0,
            1,
            "the simulation of robots became physically impossible, and their episodes were ended: look at one in the "
            "run's folder diverged/ with python -m camp.replay; a smaller sim.physics_timestep_s, less of "
            "env.randomization or lower gains (robot.kp) help, and against wild actions a lower "
            "algo.ppo.max_learning_rate",
        ),
        Alarm(
            "rows_left_out",
            lambda m: bool(_left_out(m)),
            1,
            "numbers beyond what can be observed did not go into the running mean and std: look for the entry of "
            "env.observation.policy or env.observation.critic, or the clip of motion.folder, that holds them",
            _left_out,
        ),
        # No comparison with NaN holds, so the others stay silent once it has spread.
        Alarm(
            "not_finite",
            lambda m: bool(_not_finite(m)),
            1,
            "training has diverged and learns nothing more: go back to an earlier checkpoint, with a lower "
            "algo.ppo.learning_rate, algo.style.learning_rate or algo.skill.learning_rate",
            _not_finite,
        ),
    ]


def _left_out(metrics: Metrics) -> list[str]:
    return [key for key, value in metrics.items() if key.endswith("/rows_left_out") and value > 0.0]


def _not_finite(metrics: Metrics) -> list[str]:
    return [key for key, value in metrics.items() if not isfinite(value)]


class AlarmMonitor:
    """Counts for how many iterations on end each condition has held."""

    def __init__(self, alarms: list[Alarm]) -> None:
        self.alarms = alarms
        self._held = {alarm.name: 0 for alarm in alarms}
        self._metrics: Metrics = {}  # of the last iteration

    def update(self, metrics: Metrics) -> dict[str, float]:
        """Take in one iteration; ``alarm/<name>`` for each alarm, 1 while it rings and else 0."""
        self._metrics = metrics
        for alarm in self.alarms:
            self._held[alarm.name] = self._held[alarm.name] + 1 if alarm.holds(metrics) else 0
        return {f"alarm/{alarm.name}": float(self._held[alarm.name] >= alarm.patience) for alarm in self.alarms}

    def new(self) -> list[str]:
        """A line for each alarm that the last iteration set off."""
        return [
            f"alarm {alarm.name}{self._named(alarm)}, for {alarm.patience} iteration{'s' * (alarm.patience > 1)}: "
            f"{alarm.remedy}"
            for alarm in self.alarms
            if self._held[alarm.name] == alarm.patience
        ]

    def _named(self, alarm: Alarm) -> str:
        keys = alarm.culprits(self._metrics)
        more = f" and {len(keys) - NAMED} more" if len(keys) > NAMED else ""
        return f" ({', '.join(keys[:NAMED])}{more})" if keys else ""

    def state_dict(self) -> dict[str, int]:
        return dict(self._held)

    def load_state_dict(self, state: dict[str, int]) -> None:
        self._held |= state
