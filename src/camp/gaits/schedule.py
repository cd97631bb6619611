"""Gaits as data: which leg stands when.

Legs are always in the order FL, FR, RL, RR. A leg's phase runs from 0 at its touchdown to 1 at its next one;
it stands while the phase is below the duty factor. Phase offsets follow Hildebrand's description of
symmetrical (trot, pace) and in-phase (bound, pronk) gaits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camp.common.errors import ConfigError

# Touchdown of FL, FR, RL, RR as a fraction of the stride.
GAIT_PHASES: dict[str, tuple[float, float, float, float]] = {
    "trot": (0.0, 0.5, 0.5, 0.0),
    "pace": (0.0, 0.5, 0.0, 0.5),
    "bound": (0.0, 0.0, 0.5, 0.5),
    "pronk": (0.0, 0.0, 0.0, 0.0),
}

# Control intervals per stride: about 25 ms at 2 Hz and 21 ms at 3 and 4 Hz.
GRID_STEPS: dict[float, int] = {2.0: 20, 3.0: 16, 4.0: 12}

# Fraction of the stride a leg stands. Every value times GRID_STEPS is a whole number, so that contact switches
# fall on the grid of the controller. Bound and pronk need a flight phase; at 2 Hz a pronk with duty .5 would
# have to leap 7.7 cm high, so it stands longer.
DUTY_FACTOR: dict[str, dict[float, float]] = {
    "trot": {2.0: 0.5, 3.0: 0.5, 4.0: 0.5},
    "pace": {2.0: 0.5, 3.0: 0.5, 4.0: 0.5},
    "bound": {2.0: 0.45, 3.0: 7 / 16, 4.0: 5 / 12},
    "pronk": {2.0: 0.6, 3.0: 0.5, 4.0: 0.5},
}

# Times that were summed up from physics steps land a hair beside the switch they mean.
_PHASE_TOLERANCE = 1e-6


@dataclass(frozen=True)
class GaitSchedule:
    """Contact schedule of one gait at one stride frequency, periodic in time, stride beginning at t = 0.

    Raises ConfigError when the gait or the frequency is not in the tables above.
    """

    gait: str
    frequency_hz: float

    def __post_init__(self) -> None:
        if self.gait not in GAIT_PHASES:
            raise ConfigError(f"gait '{self.gait}' is unknown; choose from {', '.join(GAIT_PHASES)}")
        if self.frequency_hz not in GRID_STEPS:
            choices = ", ".join(f"{frequency:g}" for frequency in GRID_STEPS)
            raise ConfigError(f"stride frequency {self.frequency_hz} Hz has no schedule; choose from {choices}")

    @property
    def offsets(self) -> np.ndarray:
        """Touchdown phase of each leg, (4,), in strides."""
        return np.array(GAIT_PHASES[self.gait])

    @property
    def duty(self) -> float:
        """Fraction of the stride that each leg stands."""
        return DUTY_FACTOR[self.gait][self.frequency_hz]

    @property
    def period(self) -> float:
        """Stride duration in s."""
        return 1.0 / self.frequency_hz

    @property
    def grid_steps(self) -> int:
        """Number of equal control intervals in a stride."""
        return GRID_STEPS[self.frequency_hz]

    @property
    def grid_period(self) -> float:
        """Length of one control interval in s."""
        return self.period / self.grid_steps

    @property
    def stance_duration(self) -> float:
        """Time a leg stands per stride in s."""
        return self.duty * self.period

    @property
    def swing_duration(self) -> float:
        """Time a leg swings per stride in s."""
        return (1.0 - self.duty) * self.period

    def phase(self, time: float | np.ndarray) -> np.ndarray:
        """Phase of each leg in [0, 1) at `time` (s): shape (..., 4) for time of shape (...)."""
        strides = np.asarray(time, dtype=float)[..., None] * self.frequency_hz - self.offsets
        return np.maximum(np.mod(strides + _PHASE_TOLERANCE, 1.0) - _PHASE_TOLERANCE, 0.0)

    def contact(self, time: float | np.ndarray) -> np.ndarray:
        """Which legs should stand at `time` (s): bool (..., 4) for time of shape (...)."""
        return self.phase(time) < self.duty - _PHASE_TOLERANCE

    def grid_index(self, time: float) -> int:
        """Index of the control interval that holds `time`, counted from t = 0 (negative before it)."""
        return int(np.floor(time / self.grid_period + _PHASE_TOLERANCE))


def nominal_duty(gait: str, frequency_hz: float) -> float:
    """Duty factor of a gait at any stride frequency: the table's, interpolated, for motion from elsewhere too."""
    table = DUTY_FACTOR[gait]
    return float(np.interp(frequency_hz, list(table), list(table.values())))


def nominal_contact(gait: str, frequency_hz: float, time: np.ndarray) -> np.ndarray:
    """Which legs should stand, bool (..., 4), at `time` (...) in s, at any stride frequency."""
    phase = np.mod(np.asarray(time, dtype=float)[..., None] * frequency_hz - GAIT_PHASES[gait], 1.0)
    return phase < nominal_duty(gait, frequency_hz)


def nominal_flight(gait: str, frequency_hz: float) -> float:
    """Fraction of the stride in which no leg stands."""
    moments = (np.arange(1200) + 0.5) / 1200 / frequency_hz
    return float(1.0 - nominal_contact(gait, frequency_hz, moments).any(axis=-1).mean())
