"""Checks that every table of frames has to pass, and the reading of CSV and NPY."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from camp.common.errors import ClipError
from camp.common.foreign import foreign_file
from camp.robots.quadruped import JOINT_NAMES

FEWEST_FRAMES = 4
LARGEST = 1e6  # of any number of a motion, in m, rad or their rates
_UNIT_TOLERANCE = 0.01  # files print five decimals or fewer
_SEPARATORS = (";", "\t", ",")  # in this order: decimal commas stand beside semicolons; else spaces


def check_table(table: np.ndarray, num_columns: int, name: str) -> np.ndarray:
    """The table (N, num_columns) as float64. Raises ClipError for another shape, too few frames, NaN."""
    if table.ndim != 2 or table.shape[1] != num_columns:
        raise ClipError(f"{name} has shape {table.shape}, expected (frames, {num_columns}); pass another --format")
    if len(table) < FEWEST_FRAMES:
        raise ClipError(f"{name} holds {len(table)} frames, at least {FEWEST_FRAMES} are needed; pass a longer motion")
    if table.dtype.kind not in "fiu":
        raise ClipError(f"{name} has dtype {table.dtype}, expected numbers; save it as float32 or float64")
    table = table.astype(np.float64)
    bad = np.argwhere(~(np.abs(table) <= LARGEST))
    if len(bad):
        frame, column = bad[0]
        raise ClipError(
            f"{name} holds {table[frame, column]} in frame {frame}, column {column} ({len(bad)} such values), "
            f"expected numbers up to {LARGEST:g}; repair these frames or cut them off"
        )
    return table


def check_unit(quaternion: np.ndarray) -> None:
    """Raises ClipError where quaternions (N, 4) are not unit."""
    norm = np.linalg.norm(quaternion, axis=1)
    worst = int(np.abs(norm - 1.0).argmax())
    if abs(norm[worst] - 1.0) > _UNIT_TOLERANCE:
        raise ClipError(
            f"the root quaternion of frame {worst} has norm {norm[worst]:.3f}, expected 1; "
            "check the order of the columns and the --format"
        )


def load_npy(path: Path) -> np.ndarray:
    """The array of an .npy file; never unpickles, and reads nothing that is larger than the file."""
    with foreign_file(path, "cannot be read as .npy", "save one array of floats with numpy.save", ClipError):
        table = np.load(path, mmap_mode="r", allow_pickle=False)
        if not isinstance(table, np.ndarray):
            table.close()
            raise ValueError("an archive of arrays")
        return np.array(table)


def load_csv(path: Path) -> tuple[np.ndarray, list[str] | None]:
    """Rows (N, columns) and, where the first line is no number, its names."""
    with foreign_file(path, "cannot be read as text", "pass a CSV or NPY file", ClipError):
        lines = [line.strip() for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
    separator = next((mark for mark in _SEPARATORS if lines and mark in lines[0]), None)
    rows = [_cells(line.removeprefix("#"), separator) for line in lines]
    header = rows.pop(0) if rows and not _is_number(rows[0][0]) else None
    width = len(header or (rows[0] if rows else []))
    for index, row in enumerate(rows):
        if len(row) != width:
            raise ClipError(f"row {index} has {len(row)} numbers, the first line {width}; repair or cut the row")
        bad = next((cell for cell in row if not _is_number(cell)), None)
        if bad is not None:
            raise ClipError(
                f"row {index} holds {bad[:20]!r}, expected numbers separated by commas, semicolons, tabs or spaces"
            )
    return np.array(rows, dtype=np.float64).reshape(len(rows), width), header


def _cells(line: str, separator: str | None) -> list[str]:
    cells = [cell.strip().strip('"') for cell in line.split(separator)]
    if len(cells) > 1 and not cells[-1]:  # a separator at the end of the line
        cells.pop()
    return [cell.replace(",", ".") for cell in cells] if separator == ";" else cells


def joint_columns(header: list[str]) -> list[int]:
    """Where a CSV's named columns hold the project's joints, in the order of JOINT_NAMES."""
    missing = [name for name in JOINT_NAMES if name not in header]
    if missing:
        raise ClipError(
            f"the header does not name '{missing[0]}'; name all 12 joints ({JOINT_NAMES[0]}, ...) or drop it"
        )
    return [header.index(name) for name in JOINT_NAMES]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
