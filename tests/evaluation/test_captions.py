"""Captions of films: the skill's colour, the velocities, and bars where the feet stand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from camp.evaluation import films
from camp.evaluation.captions import Take, _velocity, caption, colour

GREY = np.full((480, 640, 3), 128, np.uint8)


def take(skill: list[str], contact: np.ndarray, command: tuple[float, float, float] = (0.6, 0.0, 0.0)) -> Take:
    steps = len(skill)
    velocity = np.linspace(0.0, 1.0, steps)[:, None] * np.ones(3)
    return Take(0.02, skill, np.array(command), velocity, contact, np.arange(19.0 * steps).reshape(steps, 19))


def shade(skill: str) -> tuple[int, ...]:
    return tuple(round(255 * part) for part in to_rgb(colour(skill)))


def test_the_title_has_the_colour_of_the_gait_that_is_asked_for():
    shown = take(["trot_2hz", "pace_3hz", "hop"], np.zeros((3, 4), bool))
    titles = [tuple(caption(GREY, shown, step)[1, 1].tolist()) for step in range(3)]
    assert titles == [shade("trot"), shade("pace"), shade("hop")] and len(set(titles)) == 3


def test_bars_of_the_feet_on_the_ground_end_at_the_present():
    contact = np.zeros((100, 4), bool)
    contact[50:, 1] = True  # FR alone, for the last second
    picture = caption(GREY, take(["trot_2hz"] * 100, contact), 99)
    rows, columns = np.nonzero((picture[240:] == shade("trot")).all(axis=-1))
    height = 480 // 24 * 2 // 3
    assert np.ptp(rows) + 1 <= height  # one row
    first, last, paper = columns.min(), columns.max(), (640 // 2 + 3 * height, 640 - height)
    assert last == pytest.approx(paper[1], abs=2)
    assert last - first == pytest.approx((paper[1] - paper[0]) / 2, abs=2)  # half of the two seconds


def test_a_picture_keeps_its_size_and_its_middle():
    picture = caption(GREY, take(["trot_2hz"], np.ones((1, 4), bool)), 0)
    assert picture.shape == GREY.shape and (picture[100:300] == 128).all()


def test_the_velocity_is_a_mean_beside_what_was_asked_for():
    shown = take(["trot_2hz"] * 101, np.zeros((101, 4), bool))
    assert _velocity(shown, 100) == "0.88 m/s, 0.60 asked for"  # mean of 0.76 to 1
    turning = take(["trot_2hz"] * 101, np.zeros((101, 4), bool), (0.3, 0.1, -0.4))
    assert _velocity(turning, 0) == "0.00 m/s, 0.30 asked for; left 0.00, 0.10; turn 0.00, -0.40 rad/s"


def test_a_film_has_a_picture_for_every_so_many_steps():
    poses = []

    def frame(qpos: np.ndarray) -> np.ndarray:
        poses.append(qpos[0])
        return GREY

    renderer: Any = SimpleNamespace(frame=frame)
    shown = take(["trot_2hz"] * 5, np.zeros((5, 4), bool))
    assert len(list(films.pictures(renderer, shown, 2, "filming"))) == 3
    assert poses == [0.0, 38.0, 76.0]
    assert len(shown.until(2).skill) == len(shown.until(2).qpos) == 2
