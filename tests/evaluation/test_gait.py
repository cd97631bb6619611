"""The grid's report: right gaits score, wrong ones stand in the confusion matrix, falls are no gait."""

from __future__ import annotations

import numpy as np
import pytest

from camp.evaluation import reading
from camp.evaluation.arrays import grid_arrays
from camp.evaluation.gait import beside_expert, performed_by_command, summarize, summarize_table_i
from camp.evaluation.reading import Reading
from camp.evaluation.recording import Recording
from camp.evaluation.tracking import summarize_tracking
from camp.gaits.skills import Skill, skill_set
from tests.evaluation.synthetic import COMMANDS, GAITS, SKILLS, STEPS, contacts, grid

RIGHT = {gait: gait for gait in GAITS}


def read(recording: Recording, skills: tuple[Skill, ...] = SKILLS) -> Reading:
    return reading.read(recording, skills, 2.0)


def accuracy(part) -> float:
    return part.gait_accuracy.value


def test_right_gaits_score_fully():
    summary = summarize(read(grid(RIGHT)))
    assert accuracy(summary.all) == 1.0 and summary.all.falls == 0
    assert summary.all.gait_accuracy.n == 8 and summary.all.gait_accuracy.low < 0.7  # 8 of 8 show little
    assert summary.skills["bound"].frequency_hz == pytest.approx(2.5, rel=0.03)
    assert summary.skills["pronk"].flight_fraction == pytest.approx(0.45, abs=0.02)
    assert summary.all.touches_per_stride == pytest.approx(1.0)
    assert summary.all.linear_error_m_s == pytest.approx(0.1)
    assert summary.all.linear_error_fast_m_s == pytest.approx(0.1)
    np.testing.assert_allclose(summary.skills["trot"].phase, [0.0, 0.5, 0.5, 0.0], atol=0.01)


def test_wrong_gaits_stand_in_the_confusion_matrix():
    summary = summarize(read(grid({"trot": "trot", "pace": "trot", "bound": "bound", "pronk": "trot"})))
    assert accuracy(summary.skills["pace"]) == 0.0
    assert accuracy(summary.all) == 0.5
    assert summary.confusion["pronk"]["trot"] == 2 and summary.confusion["trot"]["trot"] == 2
    assert summary.skills["pace"].failed["gait"] == 2 and summary.skills["trot"].failed["gait"] == 0


def test_feet_that_do_not_lift_are_told():
    flat = grid(RIGHT)
    flat.foot_height[0] *= 0.1
    summary = summarize(read(flat))
    assert summary.skills["trot"].failed["lift"] == 1 and accuracy(summary.skills["trot"]) == 0.5
    assert summary.confusion["trot"]["none"] == 1
    assert summary.labelled["trot"]["trot"] == 2  # by gait and frequency alone


def test_walks_under_table_i_by_friction():
    part_right = grid(RIGHT | {"pace": "trot"})
    found = summarize_table_i(read(part_right), np.array([0.1, 0.3, 0.1, 0.3, 0.9, 0.9, 0.9, 0.9]), [0.2, 0.4, 0.8])
    assert [(part.low, part.high) for part in found.friction] == [(None, 0.2), (0.2, 0.4), (0.4, 0.8), (0.8, None)]
    assert [part.right.value if part.right else None for part in found.friction] == [0.5, 0.5, None, 1.0]


def test_skills_of_one_frequency_ask_for_that_frequency():
    skills = skill_set(GAITS, "gait_frequency", (2.0,))  # what is shown steps at 2.5 Hz
    summary = summarize(read(grid(RIGHT), skills))
    assert accuracy(summary.all) == 0.0
    assert summary.confusion["trot_2hz"]["none"] == summary.labelled["trot_2hz"]["none"] == 2
    near = skill_set(GAITS, "gait_frequency", (2.4,))
    assert accuracy(summarize(read(grid(RIGHT), near)).all) == 1.0


def test_a_fall_is_no_gait():
    fell = grid(RIGHT)
    fell.steps_upright[0] = 300
    summary = summarize(read(fell))
    assert accuracy(summary.skills["trot"]) == 0.5 and summary.skills["trot"].falls == 1
    assert summary.confusion["trot"]["fell"] == summary.labelled["trot"]["fell"] == 1


def test_a_fall_in_the_discarded_seconds_counts():
    fell = grid(RIGHT)
    fell.steps_upright[0] = 50
    assert summarize(read(fell)).all.falls == 1


def test_the_expert_beside_it_is_the_nearest_frequency_of_the_gait(clips):
    expert = beside_expert(read(grid(RIGHT)), [clip for clip in clips if clip.frequency_hz != 3.0])
    assert expert["trot"].frequency_hz == 2.0  # shown is 2.5, the clips have 2 and 4
    assert expert["trot"].frequency_error == pytest.approx(0.25, abs=0.02)
    assert expert["trot"].duty == pytest.approx(0.5) and expert["pronk"].flight_fraction == pytest.approx(0.4)
    skills = skill_set(GAITS, "gait_frequency", (4.0,))
    assert beside_expert(read(grid(RIGHT), skills), clips)["pace_4hz"].frequency_hz == 4.0


def test_every_cell_of_the_grid_is_named():
    cells = performed_by_command(read(grid(RIGHT | {"pace": "bound"})), COMMANDS)
    assert cells["pace"] == {"forward_0.5": "bound", "in_place": "bound"}


def test_tracking_keeps_slow_and_fast_apart():
    recording = grid(RIGHT)
    recording.velocity[::2] += [0.2, 0.0, 0.0]  # the fast command of every skill
    bins = summarize_tracking(read(recording))["pace"].by_speed
    assert bins["below 0.4 m/s"].linear_error_m_s == pytest.approx(0.1)
    assert bins["from 0.4 m/s"].linear_error_m_s == pytest.approx(0.3)


def test_arrays_have_the_shapes_the_analysis_reads():
    recording = grid(RIGHT)
    saved = grid_arrays(read(recording), COMMANDS)
    assert saved["contact"].shape == (4, 2, STEPS, 4) and saved["contact"][2, 0].sum() == contacts("bound").sum()
    assert saved["performed"][:, 0].tolist() == list(GAITS)
