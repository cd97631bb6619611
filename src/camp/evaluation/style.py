"""Part "style": how near the policy's motion is to the expert's clips, and how near these are to each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camp.evaluation.reading import Reading
from camp.evaluation.report import StyleSummary
from camp.evaluation.values import mean
from camp.gaits.skills import Skill
from camp.metrics.style import nearest_distance, stride_window
from camp.motion.clips.clip import Clip, amp_state

WINDOW_S = 2.0  # compared of each motion, to the nearest whole number of strides
EXPERTS_ASKED = 32  # clips, of all skills together, whose own nearest neighbours are looked for
LEAST_SCALE = 1e-3  # of an entry that hardly varies among the clips


@dataclass(frozen=True)
class _Motion:
    window: np.ndarray  # (T, S) AMP states
    command: np.ndarray  # (3,) or, where it changes, (T, 3)

    def nearest(self, demonstrations: Sequence[_Motion], scale: np.ndarray) -> float:
        """DTW distance to the nearest demonstration of another command; nan where there is none."""
        others = [other.window for other in demonstrations if not _same(self.command, other.command)]
        return nearest_distance(self.window, others, scale)


def summarize_style(reading: Reading, skills: Sequence[Skill], clips: Sequence[Clip]) -> dict[str, StyleSummary]:
    """Mean DTW distance of AMP states to the nearest clip, see `camp.metrics.style.dtw_distance`, per skill.

    policy: of the roll-outs that stayed upright, to the clips of the commanded skill; expert_same_skill: of the
    skill's clips to each other; expert_other_skill: of the same clips to those of all other skills. Only clips of
    another command are compared: the grid repeats commands of the clips, and the expert has but one motion for each.
    The unit is the standard deviation of each entry over all clips. Clips of one held command count or, where a skill
    has none, all of its clips.
    """
    scale = np.maximum(np.concatenate([amp_state(clip) for clip in clips]).std(axis=0), LEAST_SCALE)
    demonstrations = [[_of_clip(clip) for clip in _clips_of(skill, clips)] for skill in skills]
    asked = max(1, EXPERTS_ASKED // len(skills))
    result = {}
    for label, skill in enumerate(skills):
        own = demonstrations[label]
        others = [motion for k, group in enumerate(demonstrations) if k != label for motion in group]
        chosen = np.unique(np.linspace(0, len(own) - 1, min(asked, len(own))).round().astype(int))
        experts = [own[i] for i in chosen]
        rows = np.flatnonzero((reading.wanted == label) & ~reading.fallen).tolist()
        robots = [_of_robot(reading, row) for row in rows]
        result[skill.name] = StyleSummary(
            policy=_mean_nearest(robots, own, scale),
            expert_same_skill=_mean_nearest(experts, own, scale),
            expert_other_skill=_mean_nearest(experts, others, scale),
        )
    return result


def _mean_nearest(motions: Sequence[_Motion], demonstrations: Sequence[_Motion], scale: np.ndarray) -> float | None:
    return mean(np.array([motion.nearest(demonstrations, scale) for motion in motions]))


def _same(first: np.ndarray, second: np.ndarray) -> bool:
    return first.shape == second.shape and np.allclose(first, second, atol=1e-6)


def _clips_of(skill: Skill, clips: Sequence[Clip]) -> list[Clip]:
    own = [clip for clip in clips if skill.includes(clip.gait, clip.frequency_hz)]
    return [clip for clip in own if clip.is_steady] or own


def _of_clip(clip: Clip) -> _Motion:
    rows = _rows(clip.frequency_hz, clip.dt)
    return _Motion(stride_window(amp_state(clip).astype(np.float64), clip.foot_contact, rows), clip.command)


def _of_robot(reading: Reading, row: int) -> _Motion:
    recording, first = reading.recording, reading.first_step
    rows = _rows(reading.gait.frequency_hz[row], recording.period_s)
    state, contact = recording.amp_state[row, first:].astype(np.float64), recording.step_contact[row, first:]
    return _Motion(stride_window(state, contact, rows), reading.command[row])


def _rows(frequency_hz: float, period_s: float) -> int:
    """Rows of the whole strides that are nearest to WINDOW_S; all of it where there is no stride (nan)."""
    strides = np.round(WINDOW_S * frequency_hz)
    return round((strides / frequency_hz if strides >= 1 else WINDOW_S) / period_s)
