"""Which saved checkpoint walked best, so that it is kept when newer ones push the older out."""

from __future__ import annotations

from collections.abc import Mapping

from camp.runs.metrics import Metric
from camp.training.gait_monitor import mean_accuracy


class BestCheckpoint:
    """The checkpoint with the highest gait accuracy, the mean over all skills of the latest live reading before it.

    Nothing is the best before a reading of at least one skill. Of equal ones the newest counts.
    """

    def __init__(self, num_skills: int) -> None:
        self._num_skills = num_skills
        self._state: dict[str, float] = {}  # reading: the latest; iteration, score: of the best checkpoint

    @property
    def iteration(self) -> int | None:
        """Of the best checkpoint; None before there is one."""
        return int(self._state["iteration"]) if "iteration" in self._state else None

    def read(self, metrics: Mapping[str, Metric]) -> None:
        """Take in an iteration's metrics."""
        accuracy = mean_accuracy(metrics, self._num_skills)
        if accuracy is not None:
            self._state["reading"] = accuracy

    def saved(self, iteration: int) -> None:
        """Take in that a checkpoint is being saved after ``iteration``."""
        reading = self._state.get("reading")
        if reading is not None and reading >= self._state.get("score", 0.0):
            self._state |= {"iteration": float(iteration), "score": reading}

    def state_dict(self) -> dict[str, float]:
        return dict(self._state)

    def load_state_dict(self, state: Mapping[str, float]) -> None:
        self._state = dict(state)
