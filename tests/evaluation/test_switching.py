"""Switches of made-up motion: completed in time, late, or never, and how smoothly."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from camp.evaluation.arrays import switching_arrays
from camp.evaluation.switching import find_switches, summarize_switching
from camp.gaits.skills import skill_set
from camp.robots.go2 import GO2
from tests.evaluation.synthetic import SKILLS, STEPS, contacts, sequences

ORDERS = list(permutations(range(4)))


def summarize(recording):
    return summarize_switching(GO2, recording, find_switches(recording, SKILLS), SKILLS, 1.0)


def test_every_switch_of_every_order_is_found():
    result = summarize(sequences(ORDERS))
    assert result.sequences == 24 and result.all.switches == 72 and result.falls == 0
    assert result.all.completed.value == 1.0 and result.all.seconds_90_percent <= 0.5
    assert set(result.pairs.values()) == {1.0} and len(result.pairs) == 12
    assert [part.switches for part in result.to_skill.values()] == [18] * 4


def test_the_first_sequence_is_told_by_skill():
    seconds = summarize(sequences(ORDERS[:1])).first_sequence.seconds_to_skill
    assert list(seconds) == ["trot", "pace", "bound", "pronk"] and seconds["trot"] == 0.0


def test_late_switches_are_not_completed():
    result = summarize(sequences(ORDERS[:4], late=60))  # 1.2 s behind
    assert result.all.completed.value == 0.0 and result.falls == 0


def test_one_gait_throughout_is_never_a_switch_but_to_itself():
    recording = sequences([(0, 1, 2, 3)])
    recording.contact[:] = sequences([(0, 0, 0, 0)]).contact
    result = summarize(recording)
    assert result.all.completed.value == 0.0 and result.all.seconds_median is None
    assert result.first_sequence.seconds_to_skill == {"trot": 0.0, "pace": None, "bound": None, "pronk": None}


def test_peaks_at_the_switch_stand_beside_those_of_steady_walking():
    recording = sequences([(0, 1, 2, 3)])
    recording.torque[0, 130] = 23.7  # .1 s behind the first switch, at the limit of hips and thighs
    recording.joint_velocity[:] = 0.0
    recording.joint_velocity[0, 252:] = 3.0  # behind the second
    result = summarize(recording)
    assert result.all.at_switch.peak_torque_share == pytest.approx((1.0 + 2 * 10 / 23.7) / 3)
    assert result.all.steady.peak_torque_share == pytest.approx(10 / 23.7)
    assert result.all.at_switch.velocity_jump_rad_s == pytest.approx(1.0)
    assert result.to_skill["bound"].at_switch.velocity_jump_rad_s == pytest.approx(3.0)
    assert result.all.steady.velocity_jump_rad_s == 0.0


def test_a_fall_leaves_the_later_windows_out():
    recording = sequences([(0, 1, 2, 3)])
    recording.steps_upright[0] = 260
    recording.contact[0, 260:] = False
    recording.torque[0, 260:] = 1e3
    result = summarize(recording)
    assert result.falls == 1 and result.first_sequence.fell
    assert result.all.at_switch.peak_torque_share == pytest.approx(10 / 23.7)


def test_a_single_gait_has_no_switches():
    recording = sequences([(2, 2, 2, 2)])
    result = summarize(recording)
    assert result.all.switches == 0 and result.all.completed is None
    assert result.all.at_switch.peak_torque_share is None


def test_arrays_hold_the_first_sequence_and_every_switch():
    recording = sequences(ORDERS[:3])
    saved = switching_arrays(recording, find_switches(recording, SKILLS))
    assert saved["skill_switch_contact"].shape == (STEPS, 4) and saved["switches_contact"].shape == (3, STEPS, 4)
    assert saved["switch_step"].tolist() == [125, 250, 375] * 3
    np.testing.assert_array_equal(saved["switch_to"][:3], [1, 2, 3])


def test_a_change_of_frequency_alone_is_seen():
    skills = skill_set(("trot", "pace"), "gait_frequency", (2.0, 3.0))
    made_up = sequences([(0, 1, 3, 0)])
    contact = [contacts("trot", 2.0), contacts("trot", 3.0), contacts("pace", 3.0), contacts("trot", 2.0)]
    each = STEPS // 4
    made_up.contact[0] = np.concatenate([one[k * each : (k + 1) * each] for k, one in enumerate(contact)])
    found = summarize_switching(GO2, made_up, find_switches(made_up, skills), skills, 1.0)
    assert {name: part.switches for name, part in found.by_change.items()} == {"gait": 1, "frequency": 1, "both": 1}
    assert all(part.completed.value == 1.0 for part in found.by_change.values())
    made_up = made_up.take(slice(None))
    made_up.contact[0, each : 2 * each] = contacts("trot", 2.0)[each : 2 * each]
    found = summarize_switching(GO2, made_up, find_switches(made_up, skills), skills, 1.0)
    assert found.by_change["frequency"].completed.value == 0.0
