"""Gait schedules against contact patterns written out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from camp.common.errors import ConfigError
from camp.gaits.gait import GAITS, Gait
from camp.gaits.schedule import GaitSchedule

ALL = [(gait.name, frequency) for gait in GAITS.values() for frequency in gait.duty]


@pytest.mark.parametrize(
    ("gait", "first_quarter", "third_quarter"),
    [
        ("trot", [1, 0, 0, 1], [0, 1, 1, 0]),  # diagonal pairs
        ("pace", [1, 0, 1, 0], [0, 1, 0, 1]),  # lateral pairs
        ("bound", [1, 1, 0, 0], [0, 0, 1, 1]),  # front pair, hind pair
        ("pronk", [1, 1, 1, 1], [0, 0, 0, 0]),
    ],
)
def test_legs_that_stand(gait: str, first_quarter: list[int], third_quarter: list[int]) -> None:
    schedule = GaitSchedule(gait, 2.0)
    assert schedule.contact(0.05).tolist() == first_quarter
    # A pronk with duty .6 flies from .3 s on, the others change legs at .25 s.
    assert schedule.contact(0.35).tolist() == third_quarter


@pytest.mark.parametrize(("gait", "frequency"), ALL)
def test_every_leg_stands_its_duty(gait: str, frequency: float) -> None:
    schedule = GaitSchedule(gait, frequency)
    times = (np.arange(6000) + 0.5) / 6000 * schedule.period
    fraction = schedule.contact(times).mean(0)
    np.testing.assert_allclose(fraction, schedule.duty, atol=1e-3)


@pytest.mark.parametrize(("gait", "frequency"), ALL)
def test_contact_switches_fall_on_the_grid(gait: str, frequency: float) -> None:
    schedule = GaitSchedule(gait, frequency)
    assert schedule.duty * schedule.grid_steps == pytest.approx(round(schedule.duty * schedule.grid_steps))
    within = (np.arange(schedule.grid_steps)[:, None] + [0.01, 0.5, 0.99]) * schedule.grid_period
    contact = schedule.contact(within)
    assert (contact == contact[:, :1]).all()


def test_switch_belongs_to_what_follows() -> None:
    schedule = GaitSchedule("trot", 2.0)
    for stride in range(5):
        touchdown = sum([0.005] * (100 * stride))  # summed like a simulation's clock
        assert schedule.contact(touchdown)[0]
        assert not schedule.contact(touchdown + 0.25)[0]


def test_phase_and_periodicity() -> None:
    schedule = GaitSchedule("bound", 4.0)
    np.testing.assert_allclose(schedule.phase(0.0625), [0.25, 0.25, 0.75, 0.75], atol=1e-9)
    times = np.linspace(0.0, 0.25, 77)
    np.testing.assert_array_equal(schedule.contact(times), schedule.contact(times + 3 * schedule.period))


def test_grid_index_counts_from_the_start() -> None:
    schedule = GaitSchedule("trot", 2.0)  # 25 ms
    assert [schedule.grid_index(time) for time in (-0.01, 0.0, 0.024, 0.025, 0.5)] == [-1, 0, 0, 1, 20]


def test_only_bound_and_pronk_fly() -> None:
    for gait, frequency in ALL:
        schedule = GaitSchedule(gait, frequency)
        times = (np.arange(1000) + 0.5) / 1000 * schedule.period
        flies = bool((~schedule.contact(times)).all(axis=1).any())
        assert flies == (gait in ("bound", "pronk"))


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ({"name": "Walk"}, "small letters"),
        ({"phases": (0.0, 0.5, 0.75, 1.0)}, "four of"),
        ({"duty": {2.5: 0.75}}, "choose frequencies from 2, 3, 4"),
        ({"duty": {2.0: 0.74}}, "a multiple of 1/20"),
        ({"duty": {2.0: 1.0}}, "a multiple of 1/20"),
    ],
)
def test_a_record_that_nobody_could_walk_is_refused(record: dict, words: str) -> None:
    walk: dict = {"name": "walk", "phases": (0.0, 0.5, 0.75, 0.25), "duty": {2.0: 0.75}, "colour": "#56B4E9"}
    Gait(**walk)
    with pytest.raises(ConfigError, match=words):
        Gait(**walk | record)


@pytest.mark.parametrize(("gait", "frequency"), [("walk", 2.0), ("trot", 2.5)])
def test_unknown_gait_or_frequency(gait: str, frequency: float) -> None:
    with pytest.raises(ConfigError, match=r"choose from"):
        GaitSchedule(gait, frequency)
