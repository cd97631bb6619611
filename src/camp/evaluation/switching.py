"""Part "switching": from one gait into another while walking, in many orders and at several commands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camp.evaluation.rollout import Recording
from camp.evaluation.values import by_kind, mean
from camp.gaits.skills import Skill
from camp.metrics.effort import torque_use, velocity_jump
from camp.metrics.gait import label_over_time, switch_time
from camp.metrics.switching import fraction_within, peak_in_windows, quantile_of_switches
from camp.metrics.tracking import joint_tracking_accuracy, joint_tracking_of_range
from camp.robots import go2

WINDOW_S = 0.5  # behind a switch and, for steady walking, before the next one or the end


@dataclass
class Switches:
    """M beginnings of a skill in the sequences; those at step 0, from standing, are no switches."""

    robot: NDArray[np.integer]  # (M,)
    begin: NDArray[np.integer]  # (M,) step at which the skill was commanded
    end: NDArray[np.integer]  # (M,) step at which the next one was, or the sequence's length
    before: NDArray[np.integer]  # (M,) label until then, -1 at step 0
    after: NDArray[np.integer]  # (M,) label from then on
    seconds: NDArray[np.floating]  # (M,) until the gait was established, nan for never

    @property
    def true(self) -> NDArray[np.bool_]:
        """(M,) those from one skill to another."""
        return self.before >= 0


def find_switches(recording: Recording, skills: Sequence[Skill]) -> Switches:
    """When each commanded gait was held for a full second.

    A second is too short to tell stride frequencies apart, so that the gait alone counts.
    """
    rows, period = [], recording.period_s
    for robot, skill in enumerate(recording.skill):
        label = label_over_time(recording.contact[robot], period)
        begins = np.flatnonzero(np.diff(skill, prepend=-1))
        ends = [*begins[1:], len(skill)]
        for begin, end in zip(begins, ends, strict=True):
            before = skill[begin - 1] if begin else -1
            taken = switch_time(label[:end], skills[skill[begin]].gait, int(begin), period)
            rows.append((robot, begin, end, before, skill[begin], taken))
    robot, begin, end, before, after, seconds = map(np.array, zip(*rows, strict=True))
    return Switches(robot, begin, end, before, after, seconds)


def summarize_switching(
    recording: Recording, switches: Switches, skills: Sequence[Skill], within_s: float
) -> dict[str, Any]:
    """How reliably, quickly and smoothly gaits change, over all and by the gait that is switched to."""
    upright = ~recording.fallen
    joints = recording.joint_target[upright], recording.joint_position[upright]
    gaits = np.array([skill.gait for skill in skills])
    after, before = gaits[switches.after], gaits[switches.before]
    true = switches.true
    names = dict.fromkeys(after.tolist())
    return {
        "sequences": len(recording),
        "falls": int(recording.fallen.sum()),
        "within_s": within_s,
        **_timing(switches.seconds[true], within_s),
        **_smoothness(recording, switches, np.ones_like(true)),
        "to_gait": {
            name: _timing(switches.seconds[true & (after == name)], within_s)
            | _smoothness(recording, switches, after == name)
            for name in names
        },
        "pairs": {
            f"{first} to {second}": fraction_within(
                switches.seconds[true & (before == first) & (after == second)], within_s
            )
            for first in names
            for second in names
            if first != second
        },
        "joint_tracking": by_kind(joint_tracking_accuracy(*joints)),
        "joint_tracking_of_range": by_kind(joint_tracking_of_range(*joints)),
        "first_sequence": _first_sequence(recording, switches, skills),
    }


def _timing(seconds: NDArray[np.floating], within_s: float) -> dict[str, Any]:
    return {
        "switches": len(seconds),
        "established": fraction_within(seconds, within_s),
        "seconds_median": quantile_of_switches(seconds, 0.5),
        "seconds_90_percent": quantile_of_switches(seconds, 0.9),
    }


def _smoothness(recording: Recording, switches: Switches, chosen: NDArray[np.bool_]) -> dict[str, Any]:
    """Peaks in the half second behind the switches ``chosen`` (M,), beside those in the last half second of the same
    skills."""
    length = round(WINDOW_S / recording.period_s)
    torque = torque_use(recording.torque, np.array(go2.TORQUE_LIMIT)).max(axis=2)  # (R, T)
    jump = velocity_jump(recording.joint_velocity)
    upright = recording.steps_upright[switches.robot]
    behind = chosen & switches.true & (switches.begin + length <= upright)
    steady = chosen & (switches.end <= upright)
    windows = {
        "at_switch": np.stack([switches.robot, switches.begin], axis=1)[behind],
        "steady": np.stack([switches.robot, switches.end - length], axis=1)[steady],
    }
    return {
        key: {
            "peak_torque_share": mean(peak_in_windows(torque, starts, length)),
            "velocity_jump_rad_s": mean(peak_in_windows(jump, starts, length)),
        }
        for key, starts in windows.items()
    }


def _first_sequence(recording: Recording, switches: Switches, skills: Sequence[Skill]) -> dict[str, Any]:
    """The sequence that is filmed and drawn: s until each gait was established, None for never."""
    rows = np.flatnonzero(switches.robot == 0)
    seconds = {
        skills[switches.after[row]].name: None if np.isnan(switches.seconds[row]) else float(switches.seconds[row])
        for row in rows
    }
    return {"fell": bool(recording.fallen[0]), "seconds_to_gait": seconds}
