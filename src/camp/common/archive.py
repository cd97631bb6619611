"""Arrays out of an .npz that anyone may have made: sizes are known before anything is unpacked, nothing is executed."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

LARGEST_ARRAYS = 2**26  # bytes of all arrays together; a clip of an hour takes half of it, a full evaluation a tenth
_SUFFIX = ".npy"


def read_arrays(path: Path, names: Sequence[str] | None = None) -> dict[str, np.ndarray]:
    """The arrays of a file, or those of the given names that it has.

    Raises ValueError, or what zipfile and numpy raise on a damaged file: see `camp.common.foreign.foreign_file`.
    """
    with zipfile.ZipFile(path) as archive:
        members = {info.filename.removesuffix(_SUFFIX): info for info in archive.infolist()}
        chosen = {name: info for name, info in members.items() if names is None or name in names}
        size = sum(info.file_size for info in chosen.values())
        if size > LARGEST_ARRAYS:
            raise ValueError(f"unpacks to {size / 2**20:.0f} MiB, at most {LARGEST_ARRAYS / 2**20:.0f} are read")
        return {name: _read(archive, info) for name, info in chosen.items()}


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> np.ndarray:
    """One array, after its own header has been compared with the size in the zip directory."""
    if info.flag_bits & 1:
        raise ValueError(f"{info.filename} is encrypted")
    with archive.open(info) as member:
        version = npy.read_magic(member)
        read_header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, _, dtype = read_header(member)
        size = math.prod(shape) * dtype.itemsize
        if not dtype.hasobject and size > info.file_size:
            raise ValueError(f"{info.filename} holds {info.file_size} bytes, its header says {size}")
    with archive.open(info) as member:
        return npy.read_array(member, allow_pickle=False)
