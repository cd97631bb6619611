"""Style: an expert's own motion is at distance 0, and each skill's clips are nearer to each other than to others."""

from __future__ import annotations

import numpy as np
import pytest

from camp.evaluation.reading import read
from camp.evaluation.style import summarize_style
from camp.motion.clips.clip import amp_state
from camp.motion.clips.mirror import mirrored
from tests.evaluation.synthetic import GAITS, SKILLS, recording

pytestmark = [pytest.mark.slow, pytest.mark.dtw]


@pytest.fixture
def steady(clips):
    return [clip for clip in clips if clip.is_steady and clip.frequency_hz == 2.0]


def style_of(shown, commands, steady):
    """Of a policy that shows one clip for each gait at the given commands."""
    skill = np.repeat(np.arange(4)[:, None], len(shown[0]), axis=1)
    made_up = recording(skill, np.stack(commands), np.stack([clip.foot_contact for clip in shown]))
    made_up.amp_state[:] = np.stack([amp_state(clip) for clip in shown])
    return summarize_style(read(made_up, SKILLS, 0.0), SKILLS, steady)


def of_each_gait(steady):
    return [next(clip for clip in steady if clip.gait == gait and clip.command[0] == 0.6) for gait in GAITS]


def test_the_expert_as_policy_is_at_distance_zero(steady):
    shown = of_each_gait(steady)
    shown[3] = shown[0]  # commanded to pronk, it trots
    style = style_of(shown, [clip.command + 0.01 for clip in shown], steady)
    assert style["trot"].policy == pytest.approx(0.0, abs=0.05)  # windows may differ by a row
    assert style["pronk"].policy > style["pronk"].expert_same_skill
    for skill_style in style.values():
        assert skill_style.expert_same_skill < skill_style.expert_other_skill


def test_clips_of_the_same_command_are_no_neighbours(steady):
    """Neither the clip that a policy repeats nor the mirror image of a straight walk makes a distance small."""
    shown = of_each_gait(steady)
    plain = style_of(shown, [clip.command for clip in shown], steady)
    assert plain["trot"].policy > 0.1
    straight = [mirrored(clip) for clip in steady if not clip.command[1:].any()]
    assert style_of(shown, [clip.command for clip in shown], [*steady, *straight])["trot"].policy == pytest.approx(
        plain["trot"].policy, abs=0.05
    )
