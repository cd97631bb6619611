"""The contact schedule of a gait at a stride frequency: which leg stands when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camp.common.errors import ConfigError
from camp.gaits.gait import GAITS, GRID_STEPS

# Touchdown of FL, FR, RL, RR as a fraction of the stride, by the gait's name.
GAIT_PHASES: dict[str, tuple[float, float, float, float]] = {name: gait.phases for name, gait in GAITS.items()}

# Times that were summed up from physics steps land a hair beside the switch they mean.
_PHASE_TOLERANCE = 1e-6


@dataclass(frozen=True)
class GaitSchedule:
    """Contact schedule of one gait at one stride frequency, periodic in time, stride beginning at t = 0.

    Raises ConfigError where there is no such gait, or none at this frequency.
    """

    gait: str
    frequency_hz: float

    def __post_init__(self) -> None:
        if self.gait not in GAIT_PHASES:
            raise ConfigError(f"gait '{self.gait}' is unknown; choose from {', '.join(GAIT_PHASES)}")
        if self.frequency_hz not in GAITS[self.gait].duty:
            choices = ", ".join(f"{frequency:g}" for frequency in GAITS[self.gait].duty)
            raise ConfigError(
                f"stride frequency {self.frequency_hz} Hz has no schedule for a {self.gait}; choose from {choices}"
            )

    @property
    def offsets(self) -> np.ndarray:
        """Touchdown phase of each leg, (4,), in strides."""
        return np.array(GAIT_PHASES[self.gait])

    @property
    def duty(self) -> float:
        """Fraction of the stride that each leg stands."""
        return GAITS[self.gait].duty[self.frequency_hz]

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
    table = GAITS[gait].duty
    return float(np.interp(frequency_hz, list(table), list(table.values())))


def nominal_contact(gait: str, frequency_hz: float, time: np.ndarray) -> np.ndarray:
    """Which legs should stand, bool (..., 4), at `time` (...) in s, at any stride frequency."""
    phase = np.mod(np.asarray(time, dtype=float)[..., None] * frequency_hz - GAIT_PHASES[gait], 1.0)
    return phase < nominal_duty(gait, frequency_hz)


def nominal_flight(gait: str, frequency_hz: float) -> float:
    """Fraction of the stride in which no leg stands."""
    moments = (np.arange(1200) + 0.5) / 1200 / frequency_hz
    return float(1.0 - nominal_contact(gait, frequency_hz, moments).any(axis=-1).mean())
