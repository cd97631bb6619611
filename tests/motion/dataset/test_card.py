"""The card says what is in the folder, and names every key of the files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from camp.common.paths import assets_root
from camp.dataset import main
from camp.motion.clips.clip import SPLITS
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.dataset.card import KEYS, SPLIT_MEANING, dataset_card
from camp.motion.dataset.validate import check_clip
from camp.robots.go2 import GO2

FOLDER = assets_root() / "motions" / "go2"
NAMES = ("pace_2hz_left_0.25", "trot_2hz_in_place", "trot_3hz_forward_0.6")


def test_every_key_and_split_is_explained() -> None:
    with np.load(FOLDER / f"{NAMES[0]}.npz") as archive:
        assert set(KEYS) == set(archive.files)
    assert tuple(SPLIT_MEANING) == SPLITS


def test_card_counts_and_grades() -> None:
    clips = {name: load_clip(FOLDER / f"{name}.npz") for name in NAMES}
    results = {name: check_clip(GO2, clip, replay=False) for name, clip in clips.items()}
    text = dataset_card(GO2, clips, results, size=225_000)
    assert "3 clips, 600 rows, 0.2 minutes, 0.2 MB" in text
    assert "3 of 3 pass" in text
    assert "| trot | 2 | 1 |" in text
    assert "| **all** |  | 3 |" in text
    assert text.index("| steady | trot | 2 | 1 |") < text.index("| steady | pace | 2 | 1 |")
    match = min(check.value for check in results[NAMES[0]] if check.name == "contact match")
    (row,) = [line for line in text.splitlines() if line.startswith("| steady | pace | 2 |")]
    assert f"| {match:.3f} |" in row


def test_command_line_writes_the_card(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_clip(tmp_path / "clip.npz", load_clip(FOLDER / f"{NAMES[1]}.npz"))
    assert main(["card", str(tmp_path)]) == 0
    assert "1 of 1 pass" in (tmp_path / "README.md").read_text(encoding="utf-8")
    assert str(tmp_path / "README.md") in capsys.readouterr().out


def test_shipped_card_is_of_the_shipped_clips() -> None:
    paths = sorted(FOLDER.glob("*.npz"))
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert f"{len(paths)} of {len(paths)} pass" in text
    assert f"{sum(path.stat().st_size for path in paths) / 1e6:.1f} MB" in text
