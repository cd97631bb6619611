"""Clip files that anyone may have made: refused by their zip directory and headers, before anything is unpacked."""

from __future__ import annotations

import io
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from camp.common.errors import ClipError
from camp.common.paths import assets_root
from camp.motion.clips.store import clip_label, load_clip

SOURCE = assets_root() / "motions" / "go2" / "trot_3hz_forward_0.6.npz"


def rewritten(path: Path, **members: bytes) -> Path:
    """The shipped clip with members in place of its own."""
    with zipfile.ZipFile(SOURCE) as source, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for info in source.infolist():
            target.writestr(info.filename, members.get(info.filename.removesuffix(".npy"), source.read(info)))
    return path


def as_npy(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def refusal(path: Path, reader=load_clip) -> tuple[str, int]:
    """What is said, and how many bytes reading took at most."""
    tracemalloc.start()
    try:
        with pytest.raises(ClipError) as caught:
            reader(path)
        return str(caught.value), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(("name", "reader"), [("joint_position", load_clip), ("gait", clip_label)])
def test_what_unpacks_to_too_much_is_not_unpacked(tmp_path: Path, name: str, reader) -> None:
    large = as_npy(np.zeros(80 * 2**20, dtype=np.uint8))
    path = rewritten(tmp_path / "bomb.npz", **{name: large})
    assert path.stat().st_size < 200_000
    del large
    said, memory = refusal(path, reader)
    assert "cannot be read (unpacks to 80 MiB, at most 64 are read)" in said and "\n" not in said
    assert memory < 5 * 2**20


def test_a_label_is_read_beside_an_array_that_is_too_large(tmp_path: Path) -> None:
    path = rewritten(tmp_path / "bomb.npz", joint_position=as_npy(np.zeros(80 * 2**20, dtype=np.uint8)))
    assert clip_label(path).gait == "trot"


def test_a_header_that_claims_more_than_the_directory_says(tmp_path: Path) -> None:
    header = "{'descr': '<f4', 'fortran_order': False, 'shape': (10000000000, 12), }".ljust(117) + "\n"
    lying = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + bytes(1000)
    said, memory = refusal(rewritten(tmp_path / "clip.npz", joint_position=lying))
    assert "joint_position.npy holds 1128 bytes, its header says 480000000000" in said
    assert memory < 5 * 2**20


def test_an_encrypted_file_is_named(tmp_path: Path) -> None:
    content = bytearray(SOURCE.read_bytes())
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):  # flags of local and of central headers
        place = content.find(mark)
        while place >= 0:
            content[place + offset] |= 1
            place = content.find(mark, place + 4)
    path = tmp_path / "clip.npz"
    path.write_bytes(content)
    said, _ = refusal(path)
    assert ".npy is encrypted" in said and "\n" not in said


def test_flipped_bytes_are_one_line(tmp_path: Path) -> None:
    """Random damage: the file is read, or refused in one line."""
    good, rng = SOURCE.read_bytes(), np.random.default_rng(0)
    path = tmp_path / "clip.npz"
    for _ in range(150):
        content = bytearray(good)
        for place in rng.integers(0, len(good), size=4):
            content[place] = rng.integers(0, 256)
        path.write_bytes(content)
        for reader in (load_clip, clip_label):
            try:
                reader(path)
            except ClipError as error:
                assert "\n" not in str(error) and str(path) in str(error)
