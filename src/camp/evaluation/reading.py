"""What the roll-outs of a grid show, robot by robot; the parts of the report are averages of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camp.evaluation.rollout import Recording
from camp.gaits.skills import Skill, names, performed
from camp.metrics.gait import GaitMeasurement, measure_gait
from camp.metrics.tracking import VelocityError, mean_velocity, velocity_error

FELL = "fell"


@dataclass
class GridReading:
    """R roll-outs of one skill and command each, the first ``discard_s`` s left out."""

    recording: Recording  # without them; `steps_upright` still counts from the start
    skills: tuple[str, ...]  # names in label order
    wanted: NDArray[np.integer]  # (R,) label commanded
    command: NDArray[np.floating]  # (R, 3)
    velocity: NDArray[np.floating]  # (R, 3) mean
    error: VelocityError  # of the mean velocity, each (R,); a robot that fell has velocity 0 from there on
    gait: GaitMeasurement
    shown: NDArray[np.str_]  # (R,) skill performed, "none" or "fell"
    fallen: NDArray[np.bool_]  # (R,) at any time, the discarded one included

    @property
    def right(self) -> NDArray[np.bool_]:
        """(R,) roll-outs that show the commanded skill."""
        return self.shown == np.array(self.skills)[self.wanted]

    @property
    def stepping(self) -> NDArray[np.bool_]:
        """(R,) upright roll-outs in which every foot steps."""
        return self.gait.stepping.all(axis=1) & ~self.fallen

    def groups(self) -> Iterator[tuple[str, NDArray[np.bool_]]]:
        """The roll-outs (R,) of every skill, and "all"."""
        for label, name in enumerate(self.skills):
            yield name, self.wanted == label
        yield "all", np.ones(len(self.wanted), dtype=bool)


def read_grid(recording: Recording, skills: Sequence[Skill], discard_s: float) -> GridReading:
    """Gaits from measured contacts and errors of the mean velocity."""
    settled, fallen = recording.since(round(discard_s / recording.period_s)), recording.fallen
    gait = measure_gait(settled.contact, settled.period_s)
    velocity = mean_velocity(settled.velocity, settled.period_s)
    command = settled.command[:, 0]
    return GridReading(
        recording=settled,
        skills=names(skills),
        wanted=settled.skill[:, 0],
        command=command,
        velocity=velocity,
        error=velocity_error(command, velocity),
        gait=gait,
        shown=np.where(fallen, FELL, performed(gait.label, gait.frequency_hz, skills)),
        fallen=fallen,
    )
