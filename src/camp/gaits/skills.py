"""Skills: what a policy is asked to show. Each is the motion of some of the clips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LABELS = ("gait", "gait_frequency")
NO_SKILL = "none"
# Share by which a stride frequency may miss the skill's: 2, 3 and 4 Hz stay apart.
FREQUENCY_TOLERANCE = 0.15


@dataclass(frozen=True)
class Skill:
    """A gait at any of the clips' stride frequencies, or at one; its label is its place in the list of skills."""

    gait: str
    frequency_hz: float | None = None

    @property
    def name(self) -> str:
        """Such as "trot" or "trot_3hz"."""
        return self.gait if self.frequency_hz is None else f"{self.gait}_{self.frequency_hz:g}hz"

    def includes(self, gait: str, frequency_hz: float) -> bool:
        """Whether motion of this gait, meant to have this stride frequency, belongs to the skill."""
        return gait == self.gait and self.frequency_hz in (None, frequency_hz)


def skill_set(gaits: Sequence[str], labels: str, frequencies_hz: Sequence[float]) -> tuple[Skill, ...]:
    """All skills in label order: one for each gait (labels "gait"), or for each gait at each frequency
    (labels "gait_frequency")."""
    if labels == "gait":
        return tuple(Skill(gait) for gait in gaits)
    return tuple(Skill(gait, frequency) for gait in gaits for frequency in frequencies_hz)


def names(skills: Sequence[Skill]) -> tuple[str, ...]:
    """The skills' names in label order."""
    return tuple(skill.name for skill in skills)


def label_of(gait: str, frequency_hz: float, skills: Sequence[Skill]) -> int | None:
    """The label that motion of a gait and stride frequency has; None where it is no skill's."""
    return next((label for label, skill in enumerate(skills) if skill.includes(gait, frequency_hz)), None)


def performed(gait: NDArray[np.str_], frequency_hz: NDArray[np.floating], skills: Sequence[Skill]) -> NDArray[np.str_]:
    """Names (N,) of the skills that measured gaits (N,) and stride frequencies (N,) in Hz show; "none" for others."""
    shown = np.full(len(gait), NO_SKILL, dtype=object)
    for skill in skills:
        right = gait == skill.gait
        if skill.frequency_hz is not None:
            right &= np.abs(frequency_hz / skill.frequency_hz - 1.0) <= FREQUENCY_TOLERANCE
        shown[right] = skill.name
    return shown.astype(str)
