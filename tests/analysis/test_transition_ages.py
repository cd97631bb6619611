"""Which transitions show the stride frequency."""

from __future__ import annotations

import numpy as np

from analysis.transition_ages import accuracy, samples, split
from camp.gaits.skills import skill_set


def test_every_fourth_clip_is_asked_about(clips):
    skills = skill_set(("trot",), "gait_frequency", (2.0, 3.0))
    learned, asked = split(clips, skills)
    own = [clip for clip in clips if clip.gait == "trot" and clip.frequency_hz in (2.0, 3.0)]
    assert len(learned) + len(asked) == len(own)
    assert not {id(clip) for clip in learned} & {id(clip) for clip in asked}
    assert len(learned) > 2 * len(asked) > 0


def test_samples_carry_their_clips_label(clips):
    skills = skill_set(("trot", "bound"), "gait_frequency", (2.0,))
    two_hz = [clip for clip in clips if clip.frequency_hz == 2.0]
    chosen = [next(clip for clip in two_hz if clip.gait == gait) for gait in ("bound", "trot")]
    motion, label = samples(chosen, skills, (5, 0))
    assert motion.shape == (sum(len(clip) - 5 for clip in chosen), 86)
    assert label.tolist() == [1] * (len(chosen[0]) - 5) + [0] * (len(chosen[1]) - 5)


def test_states_further_apart_show_the_frequency_better(clips):
    skills = skill_set(("trot",), "gait_frequency", (2.0, 3.0, 4.0))
    own = [clip for clip in clips if clip.gait == "trot" and clip.is_steady]
    near, far = (accuracy(own, skills, ages, seed=0) for ages in ((1, 0), (8, 0)))
    assert far[0] > near[0] + 0.03
    assert near[1] == far[1] == 1.0 and np.isfinite(near[0])
