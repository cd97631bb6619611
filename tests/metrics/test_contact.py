"""Stances without their breaks; worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.common.paths import assets_root
from camp.gaits.schedule import GAIT_PHASES
from camp.metrics.contact import debounced, hysteresis, stride_fraction, touchdowns, touches_per_stride
from camp.motion.clips.store import load_clips
from camp.robots.go2 import GO2


def of(text: str) -> np.ndarray:
    """One row per character, the same for four feet."""
    return np.repeat(np.array([character == "#" for character in text])[:, None], 4, axis=1)


@pytest.mark.parametrize(
    ("seen", "meant"),
    [
        ("##.##", "#####"),
        ("##..##", "######"),  # 40 ms
        ("##...##", "##...##"),  # 60 ms
        (".##.##..", ".#####.."),  # losses at the ends stay
        ("........", "........"),
        ("#.#.#...#", "#####...#"),
    ],
)
def test_short_losses_are_closed(seen, meant):
    np.testing.assert_array_equal(debounced(of(seen), 0.02), of(meant))


def test_each_foot_and_each_walk_by_itself():
    contact = np.stack([of("##.##"), of("##...")])
    contact[0, 2, 1:] = True
    np.testing.assert_array_equal(debounced(contact, 0.02), np.stack([of("#####"), of("##...")]))


def test_a_rate_slower_than_a_bounce_leaves_everything():
    np.testing.assert_array_equal(debounced(of("#.#"), 0.06), of("#.#"))


def test_contact_begins_and_ends_at_its_own_force():
    force = np.array([0.0, 6.0, 12.0, 6.0, 4.0, 6.0, 11.0, 0.0])
    expected = [False, False, True, True, False, False, True, False]
    assert hysteresis(np.repeat(force[:, None], 4, axis=1), on=10.0, off=5.0)[:, 2].tolist() == expected


def test_touches_per_stride():
    # 2 Hz, 25 rows a stride: touchdowns at rows 5, 30, 55, 80.
    contact = np.mod(np.arange(100) - 5, 25)[None, :, None].repeat(4, axis=2) < 12
    assert touchdowns(contact[0]).tolist() == [4] * 4
    np.testing.assert_allclose(touches_per_stride(contact, np.array([2.0]), 0.02), 1.0)
    contact[0, [8, 33, 58, 83], 3] = False  # RR breaks in every stance
    assert touches_per_stride(contact, np.array([2.0]), 0.02)[0, 3] == pytest.approx(7 / 3)
    assert np.isnan(touches_per_stride(contact, np.array([np.nan]), 0.02)).all()


def test_times_between_touchdowns():
    rows = np.zeros((1, 100, 4), dtype=bool)
    rows[0, [5, 30, 55, 80], :3] = True  # every 25 rows, a stride of 2 Hz
    rows[0, [5, 30, 45, 80], 3] = True  # 25, 15 and 35 rows
    assert stride_fraction(rows, np.array([2.0]), 0.02, 0.25) == pytest.approx(1 / 3)
    assert stride_fraction(rows, np.array([2.0]), 0.02, 0.41) == 1.0
    assert stride_fraction(rows, np.array([np.nan]), 0.02, 0.25) == 0.0
    assert stride_fraction(rows[:, :20], np.array([2.0]), 0.02, 0.25) == 0.0


def test_the_expert_touches_down_once_per_stride_when_breaks_are_closed():
    """Its pronks at 2 Hz show 1.7 touches a stride at 50 Hz, as the policy's do: the soft ground, not the policy."""
    clips = load_clips(GO2, assets_root() / "motions" / "go2", tuple(GAIT_PHASES), ["steady"])
    clips = [clip for clip in clips if clip.gait == "pronk" and clip.frequency_hz == 2.0]
    contact = np.stack([clip.foot_contact for clip in clips])
    frequency = np.full(len(clips), 2.0)
    assert touches_per_stride(contact, frequency, 0.02).mean() > 1.4
    np.testing.assert_allclose(touches_per_stride(debounced(contact, 0.02), frequency, 0.02), 1.0)
