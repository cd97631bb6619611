"""Contact logs with known answers: honest gaits, and what once fooled the judge."""

from __future__ import annotations

import numpy as np

from camp.gaits.schedule import DUTY_FACTOR, GAIT_PHASES
from camp.metrics.criteria import ContactLog

PERIOD = 0.02  # s
SECONDS = 8.0


def walking(
    offsets, frequency_hz: float, duty, seconds: float = SECONDS, period_s: float = PERIOD, start: float = 0.13
) -> np.ndarray:
    """(T, 4) bool: each leg stands while frequency * time + start - offset, modulo 1, is below its duty."""
    time = np.arange(round(seconds / period_s))[:, None] * period_s
    return np.mod(time * frequency_hz + start - np.asarray(offsets), 1.0) < np.asarray(duty)


def gait_contact(gait: str, frequency_hz: float, seconds: float = SECONDS, period_s: float = PERIOD) -> np.ndarray:
    """An honest gait with the duty of the tables."""
    return walking(GAIT_PHASES[gait], frequency_hz, DUTY_FACTOR[gait][frequency_hz], seconds, period_s)


def lifted(contact: np.ndarray, height_m: float = 0.06) -> np.ndarray:
    """Heights (T, 4) of feet that rise to ``height_m`` whenever they do not stand."""
    return np.where(contact, 0.0, height_m)


def log_of(contact: np.ndarray, height_m: float = 0.06, period_s: float = PERIOD) -> ContactLog:
    """One walk with feet that lift."""
    return ContactLog(contact[None], period_s, lifted(contact, height_m)[None], period_s)


def standing(seconds: float = SECONDS) -> np.ndarray:
    return np.ones((round(seconds / PERIOD), 4), dtype=bool)


def losing_contact(loss_s: float, frequency_hz: float) -> np.ndarray:
    """A robot that stands, and whose feet lose contact together for ``loss_s`` s."""
    contact = walking((0, 0, 0, 0), frequency_hz, 1.0 - loss_s * frequency_hz)
    return contact


def two_touches(frequency_hz: float) -> np.ndarray:
    """All feet touch down twice in each stride."""
    phase = np.mod(np.arange(round(SECONDS / PERIOD)) * PERIOD * frequency_hz, 1.0)
    down = (phase < 0.25) | ((phase >= 0.5) & (phase < 0.75))
    return np.repeat(down[:, None], 4, axis=1)


def unevenly_twice(frequency_hz: float) -> np.ndarray:
    """The same, the second touch at a third of the stride."""
    phase = np.mod(np.arange(round(SECONDS / PERIOD)) * PERIOD * frequency_hz, 1.0)
    down = (phase < 0.17) | ((phase >= 0.35) & (phase < 0.6))
    return np.repeat(down[:, None], 4, axis=1)


HALF = SECONDS / 2
# What fools a judge that looks at labels of whole walks: name -> contacts (T, 4), the skill that is claimed.
FOOLING: dict[str, tuple[np.ndarray, str, float]] = {
    "stands, then trots": (np.concatenate([standing(HALF), gait_contact("trot", 2.0, HALF)]), "trot", 2.0),
    "trots, then bounds": (
        np.concatenate([gait_contact("trot", 2.0, HALF), gait_contact("bound", 2.0, HALF)]),
        "bound",
        2.0,
    ),
    "2 Hz, then 3 Hz": (np.concatenate([gait_contact("trot", f, HALF) for f in (2.0, 3.0)]), "trot", 2.0),
    "loses contact for 60 ms while standing": (losing_contact(0.06, 3.0), "pronk", 3.0),
    "limps": (walking(GAIT_PHASES["trot"], 2.0, (0.5, 0.5, 0.2, 0.5)), "trot", 2.0),
    "pronk without flight": (walking((0.0, 0.1, 0.1, 0.0), 2.0, 0.92), "pronk", 2.0),
    "pronk whose feet leave one after the other": (walking((0.0, 0.07, 0.07, 0.0), 2.0, 0.74), "pronk", 2.0),
    "bound without flight": (walking(GAIT_PHASES["bound"], 2.0, 0.59), "bound", 2.0),
    "rotary gallop": (walking((0.0, 0.1, 0.6, 0.5), 2.0, 0.45), "bound", 2.0),
    "two touches per stride": (two_touches(3.0), "pronk", 3.0),
    "two uneven touches per stride": (unevenly_twice(2.0), "pronk", 2.0),
}
