"""Style: an expert's own motion is at distance 0, and each skill's clips are nearer to each other than to others."""

from __future__ import annotations

import numpy as np
import pytest

from camp.evaluation.reading import read_grid
from camp.evaluation.style import summarize_style
from camp.motion.clips import amp_state
from tests.evaluation.synthetic import GAITS, SKILLS, recording

pytestmark = pytest.mark.slow  # the first call compiles tslearn's DTW, some ten seconds


def test_the_expert_as_policy_is_at_distance_zero(clips):
    steady = [clip for clip in clips if clip.is_steady and clip.frequency_hz == 2.0]
    shown = [next(clip for clip in steady if clip.gait == gait and clip.command[0] == 0.6) for gait in GAITS]
    steps = len(shown[0])
    skill = np.repeat(np.arange(4)[:, None], steps, axis=1)
    made_up = recording(skill, np.stack([clip.command for clip in shown]), np.stack([c.foot_contact for c in shown]))
    made_up.amp_state[:] = np.stack([amp_state(clip) for clip in shown])
    made_up.amp_state[3] = made_up.amp_state[0]  # commanded to pronk, it trots
    style = summarize_style(read_grid(made_up, SKILLS, 0.0), SKILLS, steady)
    assert style["trot"]["policy"] == pytest.approx(0.0, abs=0.05)  # windows may differ by a row
    assert style["pronk"]["policy"] > style["pronk"]["expert_same_skill"]
    for skill_style in style.values():
        assert skill_style["expert_same_skill"] < skill_style["expert_other_skill"]
