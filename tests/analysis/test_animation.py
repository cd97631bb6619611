"""The switching animation: one skill of each gait, the commanded skill in every frame, a GIF in real time."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from analysis import animation
from analysis.load import AnalysisError
from analysis.style import GAIT_COLOURS
from camp.common.paths import policies_root


class GreyRenderer:
    """Draws without OpenGL."""

    def __init__(self, *_: Any):
        self.poses: list[np.ndarray] = []

    def frame(self, qpos: np.ndarray) -> np.ndarray:
        self.poses.append(qpos)
        return np.full((animation.SIZE[1], animation.SIZE[0], 3), 128, np.uint8)

    def close(self) -> None:
        pass


def pixel(image: Image.Image, x: int, y: int) -> tuple[int, ...]:
    return tuple(np.asarray(image.convert("RGB"))[y, x].tolist())


def shade(gait: str) -> tuple[int, ...]:
    return tuple(round(255 * part) for part in to_rgb(GAIT_COLOURS[gait]))


def test_frames_show_the_commanded_skill_and_the_feet_on_the_ground():
    contact = np.zeros((16, 4), dtype=bool)
    contact[:, 1] = True  # FR alone stands
    shown = animation.Demonstration(0.02, ["trot_2hz"] * 8 + ["pace_2hz"] * 8, np.arange(16.0)[:, None], contact)
    renderer: Any = GreyRenderer()
    pictures = list(animation.frames(shown, renderer))
    assert [pose.item() for pose in renderer.poses] == [0, 4, 8, 12]
    assert [pixel(picture, animation.SIZE[0] - 2, 2) for picture in pictures[1:3]] == [shade("trot"), shade("pace")]
    present = animation.SIZE[0] - animation.MARGIN - 1
    rows = [pixel(pictures[-1], present, animation._row_top(foot) + 3) for foot in range(4)]
    assert rows == [(255, 255, 255), shade("pace"), (255, 255, 255), (255, 255, 255)]


@pytest.mark.slow
def test_the_shipped_policy_switches_and_the_file_plays_in_real_time(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(animation, "RobotRenderer", GreyRenderer)
    monkeypatch.setattr(animation, "SKILL_S", 0.32)
    path = tmp_path / "new" / "switching.gif"
    animation.animate([f"run={policies_root() / 'go2_camp'}", f"output={path}"])
    assert capsys.readouterr().out.strip() == str(path)
    with Image.open(path) as gif:
        assert (gif.n_frames, gif.info["duration"], gif.info["loop"]) == (16, 80, 0)  # type: ignore[attr-defined]
        seen = []
        for frame in range(gif.n_frames):  # type: ignore[attr-defined]
            gif.seek(frame)
            seen.append(pixel(gif, animation.SIZE[0] - 2, 2))
    for number, gait in enumerate(("trot", "pace", "bound", "pronk")):
        for colour in seen[4 * number : 4 * number + 4]:
            assert np.abs(np.subtract(colour, shade(gait))).max() < 16  # of a palette of 128


def test_a_policy_that_falls_is_told_with_the_remedy():
    metadata = {"robot": "go2"} | json.loads((policies_root() / "go2_camp" / "policy.json").read_text())
    crouch = np.tile(np.float32([0.0, 2.6, -2.7]), 4)
    policy: Any = SimpleNamespace(
        metadata=metadata,
        one_hot=lambda _: np.zeros(12),
        remembered=lambda _, frame: [frame],
        joint_target=lambda _: crouch,
    )
    with pytest.raises(AnalysisError, match=r"fell after .* s as trot_2hz: train the run further"):
        animation.demonstrate(policy, animation.Robot(metadata), ["trot_2hz"])
