"""What the single rigid body leaves out: the angular momentum of the legs.

The robot's whole angular momentum divided by its inertia is the centroidal angular velocity; the trunk turns
with another one, because the legs swing. Without the difference a sideways pronk rolls by 29 degrees. It
repeats every stride, so it is measured while walking and kept in a table over the phase.
"""

from __future__ import annotations

import numpy as np

from camp.gaits.schedule import GaitSchedule

_BLEND = 0.5  # fraction of the latest stride in the table


class LegMomentum:
    """Centroidal minus trunk angular velocity by control interval: table (N, 3), yaw frame, rad/s."""

    def __init__(self, schedule: GaitSchedule) -> None:
        self.schedule = schedule
        self.table = np.zeros((schedule.grid_steps, 3))
        self._sum = np.zeros_like(self.table)
        self._count = np.zeros((schedule.grid_steps, 1))

    def observe(self, time: float, difference: np.ndarray) -> None:
        """Add one measurement (3,) taken at `time` (s)."""
        index = self.schedule.grid_index(time) % self.schedule.grid_steps
        self._sum[index] += difference
        self._count[index] += 1.0

    def close_stride(self) -> None:
        """Blend the measurements since the last call into the table."""
        seen = self._count[:, 0] > 0
        self.table[seen] += _BLEND * (self._sum[seen] / self._count[seen] - self.table[seen])
        self._sum[:] = 0.0
        self._count[:] = 0.0

    def at(self, time: float | np.ndarray) -> np.ndarray:
        """Interpolated difference (..., 3) in rad/s at `time` (s)."""
        steps = self.schedule.grid_steps
        place = np.mod(np.asarray(time) * self.schedule.frequency_hz, 1.0) * steps - 0.5
        index = np.floor(place).astype(int)
        fraction = (place - index)[..., None]
        return (1.0 - fraction) * self.table[index % steps] + fraction * self.table[(index + 1) % steps]

    def rate(self, time: float) -> np.ndarray:
        """Time derivative (3,) in rad/s^2 at `time` (s)."""
        half = self.schedule.grid_period / 2
        return (self.at(time + half) - self.at(time - half)) / (2 * half)
