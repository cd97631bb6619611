"""Part "style": how near the policy's motion is to the expert's clips, and how near these are to each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from camp.evaluation.reading import GridReading
from camp.evaluation.values import mean
from camp.metrics.style import nearest_distance, stride_window
from camp.motion.clips import Clip, amp_state
from camp.motion.skills import Skill

WINDOW_S = 2.0  # compared of each motion, to the nearest whole number of strides
EXPERTS_ASKED = 32  # clips, of all skills together, whose own nearest neighbours are looked for
LEAST_SCALE = 1e-3  # of an entry that hardly varies among the clips


def summarize_style(reading: GridReading, skills: Sequence[Skill], clips: Sequence[Clip]) -> dict[str, Any]:
    """Mean DTW distance of AMP states to the nearest clip, see `camp.metrics.style.dtw_distance`, per skill.

    policy: of the roll-outs that stayed upright, to the clips of the commanded skill; expert_same_skill: of the
    skill's clips, each to the nearest other one; expert_other_skill: of the same clips to the nearest of any other
    skill. The unit is the standard deviation of each entry over all clips. Clips of one held command count or, where
    a skill has none, all of its clips.
    """
    scale = np.maximum(np.concatenate([amp_state(clip) for clip in clips]).std(axis=0), LEAST_SCALE)
    windows = [[_of_clip(clip) for clip in _clips_of(skill, clips)] for skill in skills]
    asked = max(1, EXPERTS_ASKED // len(skills))
    result = {}
    for label, skill in enumerate(skills):
        own = windows[label]
        others = [window for k, group in enumerate(windows) if k != label for window in group]
        chosen = np.unique(np.linspace(0, len(own) - 1, min(asked, len(own))).round().astype(int))
        rows = np.flatnonzero((reading.wanted == label) & ~reading.fallen).tolist()
        same = [nearest_distance(own[i], [*own[:i], *own[i + 1 :]], scale) for i in chosen]
        result[skill.name] = {
            "policy": mean(np.array([nearest_distance(_of_robot(reading, row), own, scale) for row in rows])),
            "expert_same_skill": mean(np.array(same)),
            "expert_other_skill": mean(np.array([nearest_distance(own[i], others, scale) for i in chosen])),
        }
    return result


def _clips_of(skill: Skill, clips: Sequence[Clip]) -> list[Clip]:
    own = [clip for clip in clips if skill.includes(clip.gait, clip.frequency_hz)]
    return [clip for clip in own if clip.is_steady] or own


def _of_clip(clip: Clip) -> np.ndarray:
    return stride_window(amp_state(clip).astype(np.float64), clip.foot_contact, _rows(clip.frequency_hz, clip.dt))


def _of_robot(reading: GridReading, row: int) -> np.ndarray:
    recording = reading.recording
    rows = _rows(reading.gait.frequency_hz[row], recording.period_s)
    return stride_window(recording.amp_state[row].astype(np.float64), recording.contact[row], rows)


def _rows(frequency_hz: float, period_s: float) -> int:
    """Rows of the whole strides that are nearest to WINDOW_S; all of it where there is no stride (nan)."""
    strides = np.round(WINDOW_S * frequency_hz)
    return round((strides / frequency_hz if strides >= 1 else WINDOW_S) / period_s)
