"""Files broken on purpose: `python -m camp.dataset validate` names each one with the right reason."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from camp.common.paths import assets_root
from camp.dataset import main

SOURCE = assets_root() / "motions" / "go2" / "trot_3hz_forward_0.6.npz"
JOINTS = ("joint_position", "joint_velocity", "joint_target", "joint_target_applied", "joint_torque")
FEET = ("foot_position", "foot_velocity", "foot_contact")

Arrays = dict[str, np.ndarray]


def swapped(arrays: Arrays, names: tuple[str, ...], order: list[int]) -> Arrays:
    """Legs in another order."""
    return {
        name: arrays[name].reshape(len(arrays[name]), 4, -1)[:, order].reshape(arrays[name].shape) for name in names
    }


def shifted(arrays: Arrays, rows: int, *names: str) -> Arrays:
    return {name: np.roll(arrays[name], rows, axis=0) for name in names}


def with_nan(values: np.ndarray) -> np.ndarray:
    values = values.copy()
    values[7, 3] = np.nan
    return values


BREAKS: dict[str, tuple[Callable[[Arrays], Arrays], str]] = {
    "contacts late": (
        lambda a: shifted(a, 5, "foot_contact"),
        "shifted labels: foot_contact is 5 rows late",
    ),
    "targets early": (
        lambda a: shifted(a, -6, "joint_target", "joint_target_applied"),
        "shifted labels: joint_target_applied is 6 rows early",
    ),
    "answers late": (
        lambda a: shifted(a, 3, "joint_target"),
        "shifted labels: joint_target is 3 rows late",
    ),
    "another gait's label": (
        lambda a: {"gait": np.array("bound")},
        "wrong label: gait is bound, the feet show a trot",
    ),
    "right legs first": (
        lambda a: swapped(a, JOINTS + FEET, [1, 0, 3, 2]),
        "swapped legs: all values are in the order FR, FL, RR, RL",
    ),
    "joints of rear legs first": (
        lambda a: swapped(a, JOINTS, [2, 3, 0, 1]),
        "swapped legs: joint values are in the order RL, RR, FL, FR",
    ),
    "joint velocities' legs": (
        lambda a: swapped(a, ("joint_velocity",), [1, 0, 3, 2]),
        "swapped legs: joint_velocity values are in the order FR, FL, RR, RL",
    ),
    "quaternion with w last": (
        lambda a: {"base_quaternion": np.roll(a["base_quaternion"], -1, axis=1)},
        "wrong quaternion order: base_quaternion reads as x, y, z, w",
    ),
    "not a number": (
        lambda a: {"joint_velocity": with_nan(a["joint_velocity"])},
        "'joint_velocity' holds values that are not finite",
    ),
    "60 Hz": (
        lambda a: {"dt": np.float32(1 / 60)},
        "wrong rate: dt is 0.016667 s, positions and velocities fit 0.020 s",
    ),
    "25 Hz": (
        lambda a: {"dt": np.float32(0.04)},
        "wrong rate: dt is 0.04 s, positions and velocities fit 0.020 s",
    ),
    "pickled payload": (
        lambda a: {"joint_target": np.array([{"harm": 1}], dtype=object)},
        "cannot be read (Object arrays cannot be loaded",
    ),
}


def report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What the validator says about the only clip of a folder, which must be bad."""
    assert main(["validate", str(tmp_path)]) == 1
    printed = capsys.readouterr()
    assert "1 clips, 1 bad" in printed.out
    assert str(tmp_path / "clip.npz") in printed.err
    return printed.err


@pytest.mark.parametrize("name", BREAKS)
def test_broken_clip_is_named_with_its_reason(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    change, reason = BREAKS[name]
    with np.load(SOURCE) as archive:
        arrays = dict(archive)
    np.savez_compressed(tmp_path / "clip.npz", **{**arrays, **change(arrays)})
    assert reason in report(tmp_path, capsys)


def test_truncated_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "clip.npz").write_bytes(SOURCE.read_bytes()[:30_000])
    assert "cannot be read (File is not a zip file)" in report(tmp_path, capsys)


def test_what_is_whole_passes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "clip.npz").write_bytes(SOURCE.read_bytes())
    assert main(["validate", str(tmp_path)]) == 0
    printed = capsys.readouterr()
    assert "1 clips, 0 bad" in printed.out and printed.err == ""
