"""The judge's criteria: honest gaits pass, each fooling log fails for its own reason."""

from __future__ import annotations

import numpy as np
import pytest

from camp.evaluation.fooling import PERIOD_S as PERIOD
from camp.evaluation.fooling import fooling_logs, gait_contact, log_of, standing, walking
from camp.gaits.gait import GAITS
from camp.gaits.schedule import GAIT_PHASES
from camp.metrics.criteria import CRITERIA, ContactLog, Limits, failures, is_right, lift_fraction, read_walks
from camp.metrics.gait import measure_gait

FOOLING = fooling_logs()
REASON = {
    "stands, then trots": "gait",
    "trots, then bounds": "gait",
    "2 Hz, then 3 Hz": "frequency",
    "loses contact for 60 ms while standing": "duty",
    "limps": "duty",
    "pronk without flight": "flight",
    "pronk whose feet leave one after the other": "flight",
    "bound without flight": "flight",
    "rotary gallop": "phase",
    "two touches per stride": "frequency",
    "two uneven touches per stride": "touches",
}


def failed(log: ContactLog, gait: str, frequency_hz: float | None) -> set[str]:
    found = failures(read_walks(log), gait, frequency_hz)
    assert tuple(found) == CRITERIA
    return {name for name, value in found.items() if value[0]}


@pytest.mark.parametrize("period", [0.005, 0.01, 0.02])
@pytest.mark.parametrize("gait", GAIT_PHASES)
@pytest.mark.parametrize("frequency", [2.0, 3.0, 4.0])
def test_honest_gaits_are_right(gait, frequency, period):
    log = log_of(gait_contact(gait, frequency, period_s=period), period_s=period)
    assert failed(log, gait, frequency) == set() == failed(log, gait, None)


def test_an_honest_gait_is_no_other_skill():
    log = log_of(gait_contact("pace", 3.0))
    assert failed(log, "pace", 2.0) == {"frequency"}
    assert {"gait", "phase"} <= failed(log, "trot", 3.0)


@pytest.mark.parametrize("name", FOOLING)
def test_what_fooled_the_judge_of_whole_walks_is_not_right(name):
    contact, gait, frequency = FOOLING[name]
    assert failed(log_of(contact), gait, None)  # neither the skill, nor the gait at any frequency
    assert REASON[name] in failed(log_of(contact), gait, frequency)


def test_the_fooling_logs_did_fool_a_label_of_the_whole_walk():
    labels = {name: measure_gait(contact[None], PERIOD).label[0] for name, (contact, _, _) in FOOLING.items()}
    fooled = {name for name, (_, gait, _) in FOOLING.items() if labels[name] == gait}
    assert len(fooled) >= len(FOOLING) - 1


def test_feet_that_hardly_leave_the_ground_are_not_right():
    contact = gait_contact("trot", 3.0)
    assert failed(log_of(contact, height_m=0.001), "trot", 3.0) == {"lift"}
    lame = np.where(contact, 0.0, 0.06)
    lame[:, 2] = np.minimum(lame[:, 2], 0.015)
    assert failed(ContactLog(contact[None], PERIOD, lame[None], PERIOD), "trot", 3.0) == {"lift"}
    assert failed(ContactLog(contact[None], PERIOD), "trot", 3.0) == set()  # no heights, nothing to fail


def test_lift_fraction_counts_strides():
    height = np.zeros((1, 100, 4))
    height[0, [10, 35, 60], :] = 0.03  # three of the four strides of 25 rows
    height[0, 85, :3] = 0.03  # the fourth without the last foot
    assert lift_fraction(height, np.array([2.0]), 0.02, 0.02) == pytest.approx(0.75)
    assert lift_fraction(height, np.array([np.nan]), 0.02, 0.02) == 0.0


def test_flight_of_a_bound_needs_a_fine_log():
    touching = walking(GAIT_PHASES["bound"], 2.0, 0.5, period_s=0.005)
    assert failed(log_of(touching, period_s=0.005), "bound", 2.0) == {"flight"}
    assert failed(log_of(touching[::4]), "bound", 2.0) == set()
    flying = walking(GAIT_PHASES["bound"], 2.0, 0.47, period_s=0.005)
    assert failed(log_of(flying, period_s=0.005), "bound", 2.0) == set()


def test_breaks_of_a_solver_do_not_count():
    contact = gait_contact("pronk", 2.0)
    down = contact.copy()
    rows = np.flatnonzero(contact.all(axis=1) & np.roll(contact, 3, axis=0).all(axis=1))
    down[rows[::5]] = False
    assert failed(log_of(down), "pronk", 2.0) == set()
    assert "touches" in {
        name
        for name, value in failures(read_walks(log_of(down), Limits(bounce_s=0.0)), "pronk", 2.0).items()
        if value[0]
    }


def test_measures_by_hand():
    # 2 Hz and .005 s: 100 rows a stride; front pair 0-44, hind pair 50-94, so that 5 + 5 rows fly.
    reading = read_walks(log_of(walking(GAIT_PHASES["bound"], 2.0, 0.45, period_s=0.005), period_s=0.005))
    np.testing.assert_allclose(reading.duty[0], 0.45, atol=0.002)
    assert reading.flight[0] == pytest.approx(0.1, abs=0.005) and reading.overlap[0] == 0.0
    np.testing.assert_allclose(reading.touches[0], 1.0)
    assert reading.frequency_hz[0] == pytest.approx(2.0, rel=1e-2) and reading.gait[0] == "bound"
    assert reading.gait_fraction[0] == 1.0 and reading.lift is not None and reading.lift[0] == 1.0


def test_standing_is_nothing():
    reading = read_walks(log_of(standing()))
    assert reading.gait[0] == "none" and np.isnan(reading.frequency_hz[0]) and not reading.stepping[0]
    assert not is_right(failures(reading, "trot"))[0]


def test_walks_are_read_independently():
    contacts = np.stack([gait_contact("trot", 2.0), gait_contact("pronk", 3.0), standing()])
    together = read_walks(ContactLog(contacts, PERIOD, np.where(contacts, 0.0, 0.06), PERIOD))
    alone = read_walks(log_of(contacts[1]))
    assert together.take(np.array([1])).frequency_hz == pytest.approx(alone.frequency_hz)
    assert is_right(failures(together, "pronk", 3.0)).tolist() == [False, True, False]


def test_a_tenth_of_the_windows_may_stumble():
    contact = gait_contact("trot", 2.0, 20.0)
    contact[500:515] = True  # .3 s on all feet, in 13 of 191 windows of 1 s
    assert failed(log_of(contact), "trot", 2.0) == set()
    contact[500:600] = True
    assert "gait" in failed(log_of(contact), "trot", 2.0)


def test_a_short_walk_is_refused():
    with pytest.raises(ValueError, match=r"the walk holds 1.00 s: give 2 s"):
        read_walks(log_of(gait_contact("trot", 2.0, 1.0)))


def test_every_gait_of_the_tables_is_within_the_limits():
    limits = Limits()
    assert max(duty for gait in GAITS.values() for duty in gait.duty.values()) < 1 - limits.bounce_s * 4.0
