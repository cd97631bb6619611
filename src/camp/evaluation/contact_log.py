"""Contact logs from any robot or simulator: a CSV or NPZ of four feet against time. docs/judge.md has the format."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from camp.common.archive import read_arrays
from camp.common.errors import CampError
from camp.common.foreign import foreign_file
from camp.metrics.contact import hysteresis
from camp.robots.quadruped import FOOT_NAMES

SLOWEST_PERIOD_S = 0.021  # of a log; a stance of 100 ms has five rows then
FINEST_PERIOD_S = 0.0025  # finer logs are read at this rate
JITTER = 0.1  # fraction of the period by which rows may be off before they are resampled
OFF_SHARE = 0.5  # contact by force ends below this fraction of the threshold
HEIGHTS = tuple(f"{foot}_height" for foot in FOOT_NAMES)
SKILL = "skill"
EITHER = "give a CSV or an NPZ"


@dataclass(frozen=True)
class FootLog:
    """T rows every ``period_s`` s. skill: what was asked for at each row, where the log tells."""

    period_s: float
    contact: NDArray[np.bool_]  # (T, 4) FL, FR, RL, RR
    height: NDArray[np.floating] | None  # (T, 4) m above the ground
    skill: NDArray[np.str_] | None  # (T,)

    @property
    def seconds(self) -> float:
        """How long the log is."""
        return len(self.contact) * self.period_s


def read_log(path: Path, threshold_n: float | None = None) -> FootLog:
    """Read a log. threshold_n: force in N from which on a foot stands, where the columns hold forces.

    Raises CampError in one line for a file that is missing, damaged or incomplete, for times that do not rise, a rate
    below 50 Hz, and for forces without a threshold.
    """
    columns = _read_npz(path) if path.suffix == ".npz" else _read_csv(path)
    feet, time = _feet(path, columns), columns["time"].astype(np.float64)
    if not (np.isfinite(time).all() and np.isfinite(feet).all()):
        raise _unusable(path, "holds values that are not finite", "leave such rows out")
    if len(time) < 3 or (np.diff(time) <= 0).any():
        raise _unusable(path, "its times do not rise", "give one row per moment, in s, in order")
    contact = _contacts(path, feet, threshold_n)
    height = None
    if all(name in columns for name in HEIGHTS):
        height = np.stack([columns[name].astype(np.float64) for name in HEIGHTS], axis=1)
    return _uniform(path, time, contact, height, columns.get(SKILL))


def _contacts(path: Path, feet: NDArray[np.floating], threshold_n: float | None) -> NDArray[np.bool_]:
    if threshold_n is not None:
        return hysteresis(feet, threshold_n, OFF_SHARE * threshold_n)
    if not np.isin(feet, (0.0, 1.0)).all():
        raise _unusable(path, "its feet hold other values than 0 and 1", "give threshold_n=<N> if they are forces")
    return feet > 0.5


def _uniform(
    path: Path,
    time: NDArray[np.floating],
    contact: NDArray[np.bool_],
    height: NDArray[np.floating] | None,
    skill: NDArray | None,
) -> FootLog:
    """Rows at equal times: contacts and skills hold their last value, heights run straight in between."""
    steps = np.diff(time)
    period = float(np.median(steps))
    if period > SLOWEST_PERIOD_S:
        raise _unusable(path, f"has a row every {period:.3f} s", "sample at 50 Hz or more")
    if (steps > 5 * SLOWEST_PERIOD_S).any():
        gap = time[int(np.argmax(steps))]
        raise _unusable(path, f"has a gap of {steps.max():.2f} s after {gap:.2f} s", "cut the log there")
    even = np.abs(steps / period - 1.0).max() <= JITTER and period >= FINEST_PERIOD_S
    if not even:
        period = max(period, FINEST_PERIOD_S)
        moments = time[0] + period * np.arange(int((time[-1] - time[0]) / period + 1e-9) + 1)
        rows = np.searchsorted(time, moments + 1e-9, side="right") - 1
        contact = contact[rows]
        skill = None if skill is None else skill[rows]
        if height is not None:
            height = np.stack([np.interp(moments, time, column) for column in height.T], axis=1)
    return FootLog(round(period, 9), contact, height, None if skill is None else skill.astype(str))


def _feet(path: Path, columns: Mapping[str, NDArray]) -> NDArray[np.floating]:
    missing = [name for name in ("time", *FOOT_NAMES) if name not in columns]
    if missing:
        raise _unusable(path, f"column '{missing[0]}' is missing", f"give time, {', '.join(FOOT_NAMES)}")
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise _unusable(path, f"its columns have {sorted(set(lengths.values()))} rows", "give each one row per moment")
    return np.stack([columns[name].astype(np.float64) for name in FOOT_NAMES], axis=1)


def _read_csv(path: Path) -> dict[str, NDArray]:
    with (
        foreign_file(path, f"contact log {path}: cannot be read", EITHER, CampError),
        path.open(newline="", encoding="utf-8-sig") as file,
    ):
        rows = list(csv.reader(file))
    if not rows:
        raise _unusable(path, "is empty", "give a heading and rows")
    heading = [name.strip() for name in rows[0]]
    body = [row for row in rows[1:] if row]
    for number, row in enumerate(body, start=2):
        if len(row) != len(heading):
            raise _unusable(path, f"line {number} has {len(row)} columns, the heading {len(heading)}", "mend that line")
    return {name: _column(path, name, [row[i].strip() for row in body]) for i, name in enumerate(heading)}


def _column(path: Path, name: str, texts: Sequence[str]) -> NDArray:
    if name == SKILL:
        return np.array(texts, dtype=str)
    if name not in ("time", *FOOT_NAMES, *HEIGHTS):
        return np.zeros(len(texts))  # somebody's own column
    words = {"true": "1", "false": "0"}
    try:
        return np.array([float(words.get(text.lower(), text)) for text in texts])
    except ValueError as error:
        raise _unusable(path, f"column '{name}' holds what is no number ({error})", "mend it") from error


def _read_npz(path: Path) -> dict[str, NDArray]:
    with foreign_file(path, f"contact log {path}: cannot be read", EITHER, CampError):
        arrays = read_arrays(path)
    columns = {name: arrays[name] for name in ("time", SKILL) if name in arrays}
    for key, names in (("contact", FOOT_NAMES), ("force", FOOT_NAMES), ("height", HEIGHTS)):
        if key in arrays:
            if arrays[key].ndim != 2 or arrays[key].shape[1] != len(names):
                raise _unusable(path, f"'{key}' has shape {arrays[key].shape}", "give (T, 4), legs FL, FR, RL, RR")
            columns |= dict(zip(names, arrays[key].T, strict=True))
    return columns


def _unusable(path: Path, what: str, remedy: str) -> CampError:
    return CampError(f"contact log {path}: {what}; {remedy}")
