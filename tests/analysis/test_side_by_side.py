"""The gaits side by side: a settled walk of each, four to a picture, at the rate of the control steps."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analysis import side_by_side
from analysis.load import AnalysisError
from camp.common.errors import ConfigError
from camp.deploy import Walk
from tests.analysis.test_animation import shade

SKILLS = ["trot_2hz", "trot_3hz", "pace_2hz", "bound_2hz", "pronk_2hz", "walk_2hz"]
POLICY: Any = SimpleNamespace(metadata={"control_period": 0.02, "skills": SKILLS})


def done(steps: int, fell: bool = False) -> Walk:
    qpos, rows = np.arange(steps, dtype=float)[:, None] * np.ones(19), np.ones((steps, 4), bool)
    return Walk(qpos, np.zeros((steps, 12), np.float32), np.zeros((steps, 3), np.float32), rows, fell)


def test_four_settled_walks_in_a_picture_of_720_lines(monkeypatch):
    monkeypatch.setattr(side_by_side, "walk", lambda policy, skill, command, seconds: done(round(seconds / 0.02)))
    shown = side_by_side.takes(POLICY, 0.2)
    assert [take.skill[0] for take in shown] == ["trot_3hz", "pace_2hz", "bound_2hz", "pronk_2hz"]
    assert [take.qpos[0, 0] for take in shown] == [100.0] * 4  # after 2 s
    renderer: Any = SimpleNamespace(frame=lambda qpos: np.full((360, 640, 3), 128, np.uint8))
    frames = list(side_by_side.pictures(shown, renderer))
    assert [frame.shape for frame in frames] == [(720, 1280, 3)] * 10
    corners = [tuple(frames[0][y, x].tolist()) for y, x in ((1, 1), (1, 641), (361, 1), (361, 641))]
    assert corners == [shade(gait) for gait in ("trot", "pace", "bound", "pronk")]


def test_a_policy_that_falls_is_told(monkeypatch):
    monkeypatch.setattr(side_by_side, "walk", lambda *_: done(30, fell=True))
    with pytest.raises(AnalysisError, match=r"fell after 0.60 s as trot_3hz: train the run further"):
        side_by_side.takes(POLICY, 1.0)


@pytest.mark.parametrize("text", ["soon", "0", "nan", "1e9"])
def test_seconds_that_make_no_film(text):
    with pytest.raises(ConfigError, match=f"seconds = {text}: give a number"):
        side_by_side.film(["run=nowhere", f"seconds={text}"])
