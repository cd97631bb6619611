"""Contact logs with known answers: honest gaits, and what fools a judge that looks at labels of whole walks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from camp.gaits.gait import GAITS
from camp.gaits.schedule import GAIT_PHASES
from camp.metrics.criteria import ContactLog

Bools = NDArray[np.bool_]

PERIOD_S = 0.02
SECONDS = 8.0


def walking(
    offsets: Sequence[float],
    frequency_hz: float,
    duty: ArrayLike,
    seconds: float = SECONDS,
    period_s: float = PERIOD_S,
) -> Bools:
    """(T, 4): each leg stands while its phase, frequency * time - offset modulo 1, is below its duty."""
    time = np.arange(round(seconds / period_s))[:, None] * period_s
    return np.mod(time * frequency_hz + 0.13 - np.asarray(offsets), 1.0) < np.asarray(duty)


def gait_contact(gait: str, frequency_hz: float, seconds: float = SECONDS, period_s: float = PERIOD_S) -> Bools:
    """An honest gait with the duty of the tables, (T, 4)."""
    return walking(GAIT_PHASES[gait], frequency_hz, GAITS[gait].duty[frequency_hz], seconds, period_s)


def log_of(contact: Bools, height_m: float = 0.06, period_s: float = PERIOD_S) -> ContactLog:
    """One walk (T, 4) whose feet are ``height_m`` m high whenever they do not stand."""
    height = np.where(contact, 0.0, height_m)
    return ContactLog(contact[None], period_s, height[None], period_s)


def standing(seconds: float = SECONDS) -> Bools:
    """All feet down, (T, 4)."""
    return np.ones((round(seconds / PERIOD_S), 4), dtype=bool)


def _twice(frequency_hz: float, first: float, second: tuple[float, float]) -> Bools:
    """All feet touch down twice in each stride: until ``first``, and from ``second[0]`` to ``second[1]``."""
    phase = np.mod(np.arange(round(SECONDS / PERIOD_S)) * PERIOD_S * frequency_hz, 1.0)
    down = (phase < first) | ((phase >= second[0]) & (phase < second[1]))
    return np.repeat(down[:, None], 4, axis=1)


def fooling_logs() -> dict[str, tuple[Bools, str, float]]:
    """Name -> contacts (T, 4), and the gait and stride frequency that they are passed off as."""
    half = SECONDS / 2
    trot, bound = GAIT_PHASES["trot"], GAIT_PHASES["bound"]

    def one_after_the_other(*parts: Bools) -> Bools:
        return np.concatenate(parts)

    return {
        "stands, then trots": (one_after_the_other(standing(half), gait_contact("trot", 2.0, half)), "trot", 2.0),
        "trots, then bounds": (
            one_after_the_other(gait_contact("trot", 2.0, half), gait_contact("bound", 2.0, half)),
            "bound",
            2.0,
        ),
        "2 Hz, then 3 Hz": (
            one_after_the_other(gait_contact("trot", 2.0, half), gait_contact("trot", 3.0, half)),
            "trot",
            2.0,
        ),
        "loses contact for 60 ms while standing": (walking((0.0, 0.0, 0.0, 0.0), 3.0, 0.82), "pronk", 3.0),
        "limps": (walking(trot, 2.0, (0.5, 0.5, 0.2, 0.5)), "trot", 2.0),
        "pronk without flight": (walking((0.0, 0.1, 0.1, 0.0), 2.0, 0.92), "pronk", 2.0),
        "pronk whose feet leave one after the other": (walking((0.0, 0.07, 0.07, 0.0), 2.0, 0.74), "pronk", 2.0),
        "bound without flight": (walking(bound, 2.0, 0.59), "bound", 2.0),
        "rotary gallop": (walking((0.0, 0.1, 0.6, 0.5), 2.0, 0.45), "bound", 2.0),
        "two touches per stride": (_twice(3.0, 0.25, (0.5, 0.75)), "pronk", 3.0),
        "two uneven touches per stride": (_twice(2.0, 0.17, (0.35, 0.6)), "pronk", 2.0),
    }
