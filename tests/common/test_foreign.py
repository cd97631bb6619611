"""Every reader of a file that others may have made: whatever stands in it, one line that names the file."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from camp.common.errors import CampError
from camp.common.foreign import DEEPEST, LARGEST_BYTES, check_yaml, read_json
from camp.config.resolve import load_run_config
from camp.deployment.metadata import read_metadata
from camp.deployment.package import _epochs
from camp.deployment.provenance import provenance
from camp.evaluation.contact_log import read_log
from camp.evaluation.contract import read_contract
from camp.evaluation.report import read_report
from camp.motion.clips.store import load_clip
from camp.motion.exchange.amp import read_amp
from camp.motion.exchange.motion import ImportOptions
from camp.robots.go2 import GO2
from camp.runs.checkpoint import load_checkpoint
from camp.runs.metrics import read_metrics

Reader = Callable[[Path], object]
DEEP = 2000
JSON_READERS: dict[str, Reader] = {
    "metrics.jsonl": read_metrics,
    "imitation.jsonl": _epochs,
    "versions.json": lambda path: provenance(path.parent, 1, None, None),  # pyright: ignore[reportArgumentType]
    "eval.json": lambda path: read_report(path, "evaluate it again"),
    "contract.json": read_contract,
    "motion.json": lambda path: read_amp(path, ImportOptions(robot=GO2, gait="trot")),
}
NPZ_READERS: dict[str, Reader] = {
    "clip.npz": load_clip,
    "log.npz": read_log,
}
READERS: dict[str, Reader] = {
    **JSON_READERS,
    **NPZ_READERS,
    "config.yaml": lambda path: load_run_config(path.parent),
    "log.csv": read_log,
}


def assert_refused(reader: Reader, path: Path, *words: str) -> None:
    with pytest.raises(CampError) as caught:
        reader(path)
    line = str(caught.value)
    assert "\n" not in line and len(line) < 600
    for word in words:
        assert word in line, line


@pytest.mark.parametrize("name", JSON_READERS)
@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        '{"a":' * DEEP + "1" + "}" * DEEP,
        '{"iteration": 1e999}',
        '{"a": NaN}',
        '{"a": 1' + "0" * 400 + "}",
    ],
    ids=["endless", "deep", "1e999", "NaN", "digits"],
)
def test_json(name, text, tmp_path):
    (tmp_path / name).write_text(text + "\n")
    assert_refused(JSON_READERS[name], tmp_path / name)


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000, "a: " + "{b: " * DEEP + "1" + "}" * DEEP, "".join(f"{' ' * n}a:\n" for n in range(1000))],
    ids=["endless", "braces", "indented"],
)
def test_a_deep_yaml(text, tmp_path):
    (tmp_path / "config.yaml").write_text(text)
    assert_refused(READERS["config.yaml"], tmp_path / "config.yaml", "config.yaml", "nested", str(DEEPEST))


def test_a_yaml_that_repeats_itself(tmp_path):
    lines = ["a0: &a0 [1,1,1,1,1,1,1,1,1,1]", *(f"a{n}: &a{n} [{','.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12))]
    (tmp_path / "config.yaml").write_text("\n".join(lines))
    assert_refused(READERS["config.yaml"], tmp_path / "config.yaml", "alias *a0")


@pytest.mark.parametrize("number", [".inf", ".nan", "1e999"])
def test_a_yaml_with_numbers_that_are_not_finite(number, tmp_path):
    (tmp_path / "config.yaml").write_text(f"seed: {number}\nvariant: camp\n")
    assert_refused(READERS["config.yaml"], tmp_path / "config.yaml", "config.yaml")


@pytest.mark.parametrize("name", READERS)
def test_a_huge_file_is_refused_unread(name, tmp_path):
    path = tmp_path / name
    path.touch()
    os.truncate(path, LARGEST_BYTES + 1)  # of zeros, which take no space
    assert_refused(READERS[name], path, "MiB, at most")


def encrypted(path: Path) -> Path:
    """A file of arrays whose zip directory says that they are encrypted."""
    np.savez(path, gait=np.zeros(3), period=np.zeros(1))
    content = bytearray(path.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        place = content.find(signature)
        while place >= 0:
            content[place + offset : place + offset + 2] = struct.pack("<H", 1)
            place = content.find(signature, place + 4)
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("name", NPZ_READERS)
def test_encrypted_arrays(name, tmp_path):
    assert_refused(NPZ_READERS[name], encrypted(tmp_path / name), name, "encrypted")


@pytest.mark.parametrize("name", NPZ_READERS)
def test_arrays_that_unpack_to_very_much(name, tmp_path):
    zeros = np.zeros(2**24)  # 128 MiB in 130 kB
    np.savez_compressed(tmp_path / name, gait=zeros, period=zeros, time=zeros)
    assert_refused(NPZ_READERS[name], tmp_path / name, name, "unpacks to")


def test_an_encrypted_or_swollen_checkpoint(tmp_path):
    path = tmp_path / "checkpoint_00000001.pt"
    assert_refused(load_checkpoint, encrypted(path.with_suffix(".npz")).rename(path), "encrypted")
    np.savez_compressed(path.with_suffix(".npz"), data=np.zeros(2**20))
    assert_refused(load_checkpoint, path.with_suffix(".npz").rename(path), "many times its size")


@pytest.mark.parametrize("text", ["[" * 100_000, "1e999", "NaN", "1" * 400])
def test_the_metadata_of_a_policy(text):
    with pytest.raises(CampError, match=r"^metadata kp = .*; export the policy again$"):
        read_metadata({"kp": text})


def test_what_is_plain_is_read():
    assert read_json('{"a": [1, -2.5e3, null, "NaN"]}') == {"a": [1, -2500.0, None, "NaN"]}
    check_yaml("a: {b: [1, 2]}\nc: '*d'\n")
