"""The metrics of a run, one JSON object per iteration: ``{"iteration": 12, "reward/style/raw": 0.4, ...}``.

A value that is not finite is written as null, which strict JSON readers accept. A histogram is a list of its fractions.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from camp.common.errors import CheckpointError
from camp.common.files import write_text
from camp.common.foreign import first_line, foreign_file, read_json

Metric = float | list[float]  # a list: a histogram's fractions, in the bins of camp.common.histogram


def metrics_line(iteration: int, metrics: Mapping[str, Metric]) -> str:
    """One line of the file, its end included."""
    return json.dumps({"iteration": iteration} | {key: _for_json(value) for key, value in metrics.items()}) + "\n"


def read_metrics(path: Path) -> list[dict[str, Any]]:
    """The lines of a metrics.jsonl; a last line torn by a kill is left out. Raises CheckpointError."""
    with foreign_file(path, f"metrics {path}: unreadable", "name a complete run folder", CheckpointError):
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    rows = []
    for number, line in enumerate(lines, start=1):
        try:
            row = read_json(line)
            rows.append(row | {"iteration": int(row["iteration"])})
        except (ValueError, TypeError, KeyError) as error:
            if number == len(lines) and not line.endswith("\n"):
                break
            raise CheckpointError(
                f"metrics {path} line {number}: not a metrics line ({first_line(error)}); restore the file or "
                "remove that line"
            ) from error
    return rows


def truncate_metrics(path: Path, last_iteration: int) -> None:
    """Drop the lines behind `last_iteration`, which a resumed run writes again. Raises CheckpointError."""
    kept = [row for row in read_metrics(path) if row["iteration"] <= last_iteration]
    write_text(path, "".join(json.dumps(row) + "\n" for row in kept))


def _for_json(value: Metric) -> Metric | None:
    if isinstance(value, list):
        return value
    return float(value) if math.isfinite(value) else None
