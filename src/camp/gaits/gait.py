"""The gaits: one record each, from which clips are generated, skills named, motion judged and figures drawn.

Legs are always in the order FL, FR, RL, RR. A leg's phase runs from 0 at its touchdown to 1 at its next one;
it stands while the phase is below the duty factor. Phase offsets follow Hildebrand's description of
symmetrical (trot, pace) and in-phase (bound, pronk) gaits.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from camp.common.errors import ConfigError

# Control intervals per stride by stride frequency in Hz: about 25 ms at 2 Hz and 21 ms at 3 and 4 Hz.
GRID_STEPS: dict[float, int] = {2.0: 20, 3.0: 16, 4.0: 12}


@dataclass(frozen=True)
class Gait:
    """A gait. Raises ConfigError for a record that no controller could follow."""

    name: str  # in small letters, words joined by _
    phases: tuple[float, float, float, float]  # touchdown of FL, FR, RL, RR as a fraction of the stride
    # Fraction of the stride a leg stands, by the stride frequencies in Hz that the expert walks. Every value times
    # GRID_STEPS is a whole number, so that contact switches fall on the grid of the controller.
    duty: Mapping[float, float]
    colour: str  # in figures
    # m/s forward, by stride frequency, where the expert does not bear all commands of its clips (up to 1 m/s).
    fastest: Mapping[float, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z]+(_[a-z]+)*", self.name):
            raise ConfigError(f"gait {self.name!r}: name it in small letters, words joined by _")
        if len(self.phases) != 4 or not all(0.0 <= phase < 1.0 for phase in self.phases):
            raise ConfigError(f"gait {self.name}: phases = {self.phases}: give four of [0, 1), FL, FR, RL, RR")
        for frequency, duty in self.duty.items():
            if frequency not in GRID_STEPS:
                choices = ", ".join(f"{one:g}" for one in GRID_STEPS)
                raise ConfigError(f"gait {self.name}: duty at {frequency:g} Hz: choose frequencies from {choices}")
            steps = duty * GRID_STEPS[frequency]
            if not 0.0 < duty < 1.0 or abs(steps - round(steps)) > 1e-9:
                raise ConfigError(
                    f"gait {self.name}: duty = {duty:g} at {frequency:g} Hz: choose a multiple of "
                    f"1/{GRID_STEPS[frequency]} between 0 and 1"
                )


GAITS: dict[str, Gait] = {}


def add_gait(gait: Gait) -> None:
    """Make a gait known. New ones come last: the random commands of a gait's clips are drawn by its place."""
    if gait.name in GAITS:
        raise ConfigError(f"gait {gait.name}: is there already; choose another name")
    GAITS[gait.name] = gait


# Colours: Okabe & Ito (2008), chosen to stay apart under the common colour-vision deficiencies.
add_gait(Gait("trot", (0.0, 0.5, 0.5, 0.0), {2.0: 0.5, 3.0: 0.5, 4.0: 0.5}, "#0072B2"))
add_gait(Gait("pace", (0.0, 0.5, 0.0, 0.5), {2.0: 0.5, 3.0: 0.5, 4.0: 0.5}, "#E69F00"))
# Bound and pronk need a flight phase.
add_gait(Gait("bound", (0.0, 0.0, 0.5, 0.5), {2.0: 0.45, 3.0: 7 / 16, 4.0: 5 / 12}, "#009E73"))
add_gait(
    Gait(
        "pronk",
        (0.0, 0.0, 0.0, 0.0),
        {2.0: 0.6, 3.0: 0.5, 4.0: 0.5},  # at 2 Hz with duty .5 it would have to leap 7.7 cm high
        "#CC79A7",
        # At 2 Hz it flies far: beyond this the contacts leave the schedule and the knees near their end stop.
        fastest={2.0: 0.8},
    )
)
