"""Part "switching": from one skill into another while walking, every pair, at several commands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camp.evaluation.recording import Recording
from camp.evaluation.report import FirstSequence, Peaks, SwitchGroup, SwitchingSummary
from camp.evaluation.values import fraction, mean
from camp.gaits.skills import Skill, performed
from camp.metrics.effort import torque_use, velocity_jump
from camp.metrics.gait import measure_over_time, switch_time
from camp.metrics.switching import fraction_within, peak_in_windows, quantile_of_switches
from camp.robots.robot import Robot

WINDOW_S = 0.5  # behind a switch and, for steady walking, before the next one or the end


@dataclass
class Switches:
    """M beginnings of a skill in the sequences; those at step 0, from standing, are no switches."""

    robot: NDArray[np.integer]  # (M,)
    begin: NDArray[np.integer]  # (M,) step at which the skill was commanded
    end: NDArray[np.integer]  # (M,) step at which the next one was, or the sequence's length
    before: NDArray[np.integer]  # (M,) label until then, -1 at step 0
    after: NDArray[np.integer]  # (M,) label from then on
    seconds: NDArray[np.floating]  # (M,) until the skill was completed, nan for never

    @property
    def true(self) -> NDArray[np.bool_]:
        """(M,) those from one skill to another."""
        return self.before >= 0


def find_switches(recording: Recording, skills: Sequence[Skill]) -> Switches:
    """When each commanded skill, gait and stride frequency, was held for a full second."""
    rows, period, contact = [], recording.period_s, recording.step_contact
    for robot, skill in enumerate(recording.skill):
        seen = measure_over_time(contact[robot], period)
        begins = np.flatnonzero(np.diff(skill, prepend=-1))
        ends = [*begins[1:], len(skill)]
        for begin, end in zip(begins, ends, strict=True):
            wanted, before = skills[skill[begin]], skill[begin - 1] if begin else -1
            shown = performed(seen.label[:end], seen.frequency_hz[:end], [wanted]).tolist()
            rows.append((robot, begin, end, before, skill[begin], switch_time(shown, wanted.name, int(begin), period)))
    robot, begin, end, before, after, seconds = map(np.array, zip(*rows, strict=True))
    return Switches(robot, begin, end, before, after, seconds)


def summarize_switching(
    robot: Robot, recording: Recording, switches: Switches, skills: Sequence[Skill], within_s: float
) -> SwitchingSummary:
    """Times until the new skill is completed, peaks at the switch beside steady ones, falls."""
    true, gaits = switches.true, np.array([skill.gait for skill in skills])
    hertz = np.array([skill.frequency_hz or 0.0 for skill in skills])
    after, before = gaits[switches.after], gaits[switches.before]
    other_gait, other_hz = after != before, hertz[switches.after] != hertz[switches.before]
    changes = {"gait": other_gait & ~other_hz, "frequency": ~other_gait & other_hz, "both": other_gait & other_hz}
    group = _Groups(robot, recording, switches, within_s)
    every, names = np.ones_like(true), dict.fromkeys(after.tolist())
    return SwitchingSummary(
        sequences=len(recording),
        falls=int(recording.fallen.sum()),
        within_s=within_s,
        all=group(every),
        by_change={name: group(chosen) for name, chosen in changes.items() if (chosen & true).any()},
        to_skill={skill.name: group(switches.after == label) for label, skill in enumerate(skills)},
        pairs={
            f"{first} to {second}": fraction_within(
                switches.seconds[true & (before == first) & (after == second)], within_s
            )
            for first in names
            for second in names
            if first != second
        },
        first_sequence=_first_sequence(recording, switches, skills),
    )


class _Groups:
    """Figures of some of the switches (M,) at a time."""

    def __init__(self, robot: Robot, recording: Recording, switches: Switches, within_s: float):
        self._switches, self._within = switches, within_s
        self._length = round(WINDOW_S / recording.period_s)
        self._torque = torque_use(recording.torque, np.array(robot.torque_limit)).max(axis=2)  # (R, T)
        self._jump = velocity_jump(recording.joint_velocity)
        self._upright = recording.steps_upright[switches.robot]

    def __call__(self, chosen: NDArray[np.bool_]) -> SwitchGroup:
        """Peaks in the half second behind the switches, beside those in the last half second of the same skills."""
        switches, length = self._switches, self._length
        seconds = switches.seconds[chosen & switches.true]
        behind = chosen & switches.true & (switches.begin + length <= self._upright)
        steady = chosen & (switches.end <= self._upright)
        starts = np.stack([switches.robot, switches.begin], axis=1)[behind]
        ends = np.stack([switches.robot, switches.end - length], axis=1)[steady]
        with np.errstate(invalid="ignore"):
            completed = seconds <= self._within + 1e-9
        return SwitchGroup(
            switches=len(seconds),
            completed=fraction(completed),
            seconds_median=quantile_of_switches(seconds, 0.5),
            seconds_90_percent=quantile_of_switches(seconds, 0.9),
            at_switch=self._peaks(starts),
            steady=self._peaks(ends),
        )

    def _peaks(self, starts: NDArray[np.integer]) -> Peaks:
        return Peaks(
            peak_torque_share=mean(peak_in_windows(self._torque, starts, self._length)),
            velocity_jump_rad_s=mean(peak_in_windows(self._jump, starts, self._length)),
        )


def _first_sequence(recording: Recording, switches: Switches, skills: Sequence[Skill]) -> FirstSequence:
    rows = np.flatnonzero(switches.robot == 0)
    seconds = {
        skills[switches.after[row]].name: None if np.isnan(switches.seconds[row]) else float(switches.seconds[row])
        for row in rows
    }
    return FirstSequence(fell=bool(recording.fallen[0]), seconds_to_skill=seconds)
