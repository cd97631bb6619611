"""Which saved checkpoint walked best, so that it is kept when newer ones push the older out."""

from __future__ import annotations

import math
from collections.abc import Mapping

from camp.runs.metrics import Metric
from camp.training.gait_monitor import mean_accuracy


class BestCheckpoint:
    """The checkpoint with the highest gait accuracy, the mean over all skills of the latest live reading before it.

    A reading under harder conditions (``env.hardening``) counts for more than any under easier ones. Nothing is the
    best before a reading of at least one skill. Of equal ones the newest counts.
    """

    def __init__(self, num_skills: int) -> None:
        self._num_skills = num_skills
        # reading, difficulty: the latest; iteration, score, best_difficulty: of the best checkpoint
        self._state: dict[str, float] = {}

    @property
    def iteration(self) -> int | None:
        """Of the best checkpoint; None before there is one."""
        return int(self._state["iteration"]) if "iteration" in self._state else None

    def read(self, metrics: Mapping[str, Metric]) -> None:
        """Take in an iteration's metrics."""
        accuracy = mean_accuracy(metrics, self._num_skills)
        if accuracy is not None and math.isfinite(accuracy):
            difficulty = metrics.get("env/difficulty", 1.0)
            assert isinstance(difficulty, float)
            self._state |= {"reading": accuracy, "difficulty": difficulty}

    def saved(self, iteration: int) -> None:
        """Take in that a checkpoint is being saved after ``iteration``."""
        state = self._state
        if "reading" not in state:
            return
        # States of before there was a difficulty lack it: theirs were the whole conditions.
        difficulty, reading = state.get("difficulty", 1.0), state["reading"]
        if "score" not in state or (difficulty, reading) >= (state.get("best_difficulty", 1.0), state["score"]):
            state |= {"iteration": float(iteration), "best_difficulty": difficulty, "score": reading}

    def state_dict(self) -> dict[str, float]:
        return dict(self._state)

    def load_state_dict(self, state: Mapping[str, float]) -> None:
        self._state = dict(state)
