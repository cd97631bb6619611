"""Skills: the labels that condition the policy. Each is the motion of some of the clips."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LABELS = ("gait", "gait_frequency")
NO_SKILL = "none"
# Fraction by which a stride frequency, of a clip or of what a policy shows, may miss the one asked for: 2, 3 and 4 Hz
# stay apart. Frequencies are measured or went through float32, so they are never compared for equality.
FREQUENCY_TOLERANCE = 0.15
# Strides take 10 s at most, and at 50 Hz four rows at least.
FREQUENCY_RANGE_HZ = (0.1, 12.5)


@dataclass(frozen=True)
class Skill:
    """A gait at any stride frequency, or at one; its label is its place in the list of skills."""

    gait: str
    frequency_hz: float | None = None

    @property
    def name(self) -> str:
        """Such as "trot" or "trot_3hz"."""
        return self.gait if self.frequency_hz is None else f"{self.gait}_{self.frequency_hz:g}hz"

    def includes(self, gait: str, frequency_hz: float) -> bool:
        """Whether motion of this gait and stride frequency belongs to the skill, within FREQUENCY_TOLERANCE."""
        return gait == self.gait and (self.frequency_hz is None or is_near(frequency_hz, self.frequency_hz))


def is_near(frequency_hz: float, wanted_hz: float) -> bool:
    """Whether a stride frequency is the wanted one within FREQUENCY_TOLERANCE."""
    return abs(frequency_hz / wanted_hz - 1.0) <= FREQUENCY_TOLERANCE


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
    """The label that motion of a gait and stride frequency has, the nearest skill's; None where it is no skill's."""
    error = _errors(np.array([gait]), np.array([frequency_hz]), skills)[:, 0]
    return int(error.argmin()) if np.isfinite(error).any() else None


def split_name(name: str) -> tuple[str, float | None]:
    """A skill's gait and stride frequency in Hz, None where it has none: of "trot_3hz" trot and 3."""
    match = re.fullmatch(r"(.+)_([0-9.]+)hz", name)
    return (match[1], float(match[2])) if match else (name, None)


def performed(gait: NDArray[np.str_], frequency_hz: NDArray[np.floating], skills: Sequence[Skill]) -> NDArray[np.str_]:
    """Names (N,) of the skills that measured gaits (N,) and stride frequencies (N,) in Hz show; "none" for others."""
    error = _errors(gait, frequency_hz, skills)
    shown = np.array(names(skills), dtype=object)[error.argmin(axis=0)]
    shown[np.isinf(error).all(axis=0)] = NO_SKILL
    return shown.astype(str)


def _errors(
    gait: NDArray[np.str_], frequency_hz: NDArray[np.floating], skills: Sequence[Skill]
) -> NDArray[np.floating]:
    """By which fraction motions (N,) miss each skill's frequency, (K, N); inf for another gait or beyond the
    tolerance, 0 for skills of any frequency."""
    error = np.full((len(skills), len(gait)), np.inf)
    for row, skill in zip(error, skills, strict=True):
        miss = np.zeros(len(gait)) if skill.frequency_hz is None else np.abs(frequency_hz / skill.frequency_hz - 1.0)
        fits = (gait == skill.gait) & (miss <= FREQUENCY_TOLERANCE)
        row[fits] = miss[fits]
    return error
