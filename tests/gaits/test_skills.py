"""Skills as gaits, and as gaits at one stride frequency."""

from __future__ import annotations

import numpy as np

from camp.gaits.skills import Skill, label_of, names, performed, skill_set

GAITS = ("trot", "bound")


def test_a_gait_is_one_skill_at_any_frequency():
    skills = skill_set(GAITS, "gait", (2.0, 3.0))
    assert names(skills) == ("trot", "bound")
    assert label_of("bound", 2.0, skills) == label_of("bound", 4.0, skills) == 1
    assert label_of("pace", 2.0, skills) is None


def test_a_gait_at_each_frequency_is_a_skill():
    skills = skill_set(GAITS, "gait_frequency", (2.0, 3.0))
    assert names(skills) == ("trot_2hz", "trot_3hz", "bound_2hz", "bound_3hz")
    assert label_of("bound", 2.0, skills) == 2
    assert label_of("bound", 4.0, skills) is None


def test_performed_skills_read_gait_and_frequency():
    gait = np.array(["trot", "trot", "bound", "none", "trot"])
    frequency = np.array([2.1, 3.3, 2.5, np.nan, 2.4])
    skills = skill_set(GAITS, "gait_frequency", (2.0, 3.0))
    assert performed(gait, frequency, skills).tolist() == ["trot_2hz", "trot_3hz", "none", "none", "none"]
    assert performed(gait, frequency, (Skill("trot"),)).tolist() == ["trot", "trot", "none", "none", "trot"]


def test_the_nearest_skill_counts():
    """3.42 Hz is within the tolerance of 3 and of 4 Hz."""
    skills = skill_set(("trot",), "gait_frequency", (4.0, 3.0))
    assert label_of("trot", 3.42, skills) == 1
    assert label_of("trot", 3.44, skills) == 0
    assert performed(np.array(["trot"] * 2), np.array([3.42, 3.6]), skills).tolist() == ["trot_3hz", "trot_4hz"]


def test_a_frequency_is_itself_in_single_precision():
    assert label_of("trot", float(np.float32(1.8)), skill_set(("trot",), "gait_frequency", (1.8,))) == 0
