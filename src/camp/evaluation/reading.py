"""What walks show, robot by robot; the parts of the report are averages of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camp.evaluation.recording import Recording
from camp.gaits.skills import NO_SKILL, Skill, performed
from camp.metrics.criteria import CRITERIA, WalkReading, failures, is_right, read_walks
from camp.metrics.tracking import VelocityError, mean_velocity, velocity_error

FELL = "fell"


@dataclass
class Reading:
    """R walks of one skill and command each, the first ``discard_s`` s left out of all but falls."""

    recording: Recording
    first_step: int  # from which on the walk counts
    skills: tuple[Skill, ...]
    gait: WalkReading
    velocity: NDArray[np.floating]  # (R, 3) mean
    error: VelocityError  # of the mean velocity, each (R,); a robot that fell has velocity 0 from there on
    failed: dict[str, NDArray[np.bool_]]  # (R,) by criterion, of the commanded skill
    shown: NDArray[np.str_]  # (R,) skill performed, "none" or "fell"

    @property
    def wanted(self) -> NDArray[np.integer]:
        """(R,) label commanded."""
        return self.recording.skill[:, 0]

    @property
    def command(self) -> NDArray[np.floating]:
        """(R, 3)."""
        return self.recording.command

    @property
    def fallen(self) -> NDArray[np.bool_]:
        """(R,) at any time, the discarded one included."""
        return self.recording.fallen

    @property
    def right(self) -> NDArray[np.bool_]:
        """(R,) walks that stay upright and fail no criterion of the commanded skill."""
        return is_right(self.failed) & ~self.fallen

    @property
    def labelled(self) -> NDArray[np.str_]:
        """(R,) skill whose gait and stride frequency are shown, whatever else is wrong; "none" or "fell"."""
        shown = performed(self.gait.gait, self.gait.frequency_hz, self.skills)
        return np.where(self.fallen, FELL, shown).astype(str)

    @property
    def stepping(self) -> NDArray[np.bool_]:
        """(R,) upright walks in which every foot steps."""
        return self.gait.stepping & ~self.fallen

    def groups(self) -> Iterator[tuple[str, NDArray[np.bool_]]]:
        """The walks (R,) of every skill, and "all"."""
        for label, skill in enumerate(self.skills):
            yield skill.name, self.wanted == label
        yield "all", np.ones(len(self.wanted), dtype=bool)

    def take(self, rows: NDArray[np.integer]) -> Reading:
        """The walks ``rows``."""
        return Reading(
            self.recording.take(rows),
            self.first_step,
            self.skills,
            self.gait.take(rows),
            self.velocity[rows],
            VelocityError(self.error.linear[rows], self.error.angular[rows]),
            {name: value[rows] for name, value in self.failed.items()},
            self.shown[rows],
        )


def read(recording: Recording, skills: Sequence[Skill], discard_s: float) -> Reading:
    """Gaits from measured contacts and foot heights, errors of the mean velocity."""
    first = round(discard_s / recording.period_s)
    gait = read_walks(recording.log(first))
    velocity = mean_velocity(recording.velocity[:, first:], recording.period_s)
    wanted, num = recording.skill[:, 0], len(recording)
    failed = {name: np.zeros(num, dtype=bool) for name in CRITERIA}
    shown = np.full(num, NO_SKILL, dtype=object)
    for label, skill in enumerate(skills):
        found = failures(gait, skill.gait, skill.frequency_hz)
        shown[is_right(found)] = skill.name
        for name in CRITERIA:
            failed[name] = np.where(wanted == label, found[name], failed[name])
    return Reading(
        recording=recording,
        first_step=first,
        skills=tuple(skills),
        gait=gait,
        velocity=velocity,
        error=velocity_error(recording.command, velocity),
        failed=failed,
        shown=np.where(recording.fallen, FELL, shown).astype(str),
    )
