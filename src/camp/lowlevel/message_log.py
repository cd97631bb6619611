"""Rate, age and jitter of every message, step by step and in sum."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import IO

import numpy as np

from camp.common.errors import ConfigError


@dataclass(frozen=True)
class Row:
    """One control step."""

    now_s: float  # its beginning
    state: str
    fault: str
    skill: str
    late_ms: float  # its beginning, behind its time
    work_ms: float  # from its beginning until the command was sent
    robot_ms: int  # the newest reading's time by the robot's clock; -1 before the first
    age_ms: float  # since the newest reading came, by this computer's clock
    fresh: int  # 1 where it came in this step


class MessageLog:
    """Writes a row for every control step to a CSV file, and sums them up at the end."""

    def __init__(self, path: Path | None):
        """Raises ConfigError where the file cannot be written. path: None keeps the rows in memory alone."""
        self._rows: list[Row] = []
        self._file: IO[str] | None = None
        if path is not None:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                self._file = path.open("w", newline="", encoding="utf-8")
            except OSError as error:
                raise ConfigError(f"--log {path}: {error.strerror or error}; choose a file to write") from error
            self._writer = csv.writer(self._file)
            self._writer.writerow([field.name for field in fields(Row)])

    def add(self, row: Row) -> None:
        """One more control step."""
        self._rows.append(row)
        if self._file is not None:
            self._writer.writerow([round(v, 4) if isinstance(v, float) else v for v in astuple(row)])

    def close(self) -> None:
        """No more rows."""
        if self._file is not None:
            self._file.close()

    @property
    def states(self) -> list[str]:
        """The states in the order in which they came, without repetition."""
        names = [row.state for row in self._rows]
        return [name for name, before in zip(names, ["", *names], strict=False) if name != before]

    def summary(self) -> str:
        """Three lines: readings, commands, and this computer's share."""
        if len(self._rows) < 2:
            return "no control step was made"
        seconds = self._rows[-1].now_s - self._rows[0].now_s
        came = [row for row in self._rows if row.fresh]
        robot = np.diff([row.robot_ms for row in came]) if len(came) > 1 else np.zeros(1)
        starts = np.diff([row.now_s for row in self._rows]) * 1e3
        # The two clocks are not set alike: ages are known but for the youngest reading's.
        ages = np.array([row.now_s * 1e3 - row.robot_ms for row in self._rows if row.robot_ms >= 0] or [0.0])
        late, work = [row.late_ms for row in self._rows], [row.work_ms for row in self._rows]
        return "\n".join(
            [
                f"readings used: {(len(came) - 1) / seconds:.1f} per s; by the robot's clock between them "
                f"{_spread(robot)} ms; older than the youngest by {_spread(ages - ages.min())} ms",
                f"commands sent: {(len(self._rows) - 1) / seconds:.1f} per s; between them {_spread(starts)} ms",
                f"control steps: late {_spread(late)} ms; work {_spread(work)} ms",
            ]
        )


def _spread(values: Sequence[float] | np.ndarray) -> str:
    if not len(values):
        return "-"
    median, high, most = np.percentile(values, [50, 99, 100])
    return f"{median:.2f} (99 %: {high:.2f}, most: {most:.2f})"
