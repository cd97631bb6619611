"""Joints of a leg through the sequence of skills: target, actual and the expert's mean stride (paper, Fig. 5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.contacts import Span, spans
from analysis.style import GREY, GRID, PAGE, new_figure, skill_colours, style
from camp.evaluation.recording import Recording
from camp.evaluation.report import ReferenceSummary
from camp.gaits.skills import split_name
from camp.metrics.gait import measure_gait
from camp.metrics.reference import PHASES, mean_stride
from camp.motion.clips.clip import Clip

Floats = NDArray[np.floating]

LEG = "RL"  # as in the paper
JOINTS = {"thigh": 7, "calf": 8}  # of the RL leg, among the twelve
SETTLED_S = 0.75  # behind a switch, from which the expert's stride is fitted
TARGET, ACTUAL = "#D55E00", "#0072B2"


@dataclass(frozen=True)
class JointTraces:
    """T steps. target, actual, expert: (T, 2) rad, thigh and calf; expert: nan where no stride was fitted;
    commanded: spans of skills."""

    time: Floats
    target: Floats
    actual: Floats
    expert: Floats
    commanded: list[Span]


def compute_joints(recording: Recording, skills: Sequence[str], clips: Sequence[Clip]) -> JointTraces:
    """The first robot's joints; in each skill the expert's mean stride at the robot's own rhythm and the phase that
    fits best, from the clip of the nearest command."""
    period, columns = recording.period_s, list(JOINTS.values())
    actual = recording.joint_position[0][:, columns]
    commanded = spans([skills[int(label)] for label in recording.skill[0]], period)
    expert = np.full_like(actual, np.nan)
    for span in commanded:
        first, last = round((span.start_s + SETTLED_S) / period), round(span.end_s / period)
        frequency = float(measure_gait(recording.step_contact[:1, first:last], period).frequency_hz[0])
        clip = nearest_clip(clips, span.name, recording.command[0])
        if clip is not None and np.isfinite(frequency):
            stride = mean_stride(clip.joint_position, clip.frequency_hz, clip.dt)[:, columns]
            expert[first:last] = fit(stride, actual[first:last], frequency * period)
    time = np.arange(len(actual)) * period
    return JointTraces(time, recording.joint_target[0][:, columns], actual, expert, commanded)


def nearest_clip(clips: Sequence[Clip], skill: str, command: Floats) -> Clip | None:
    """The steady clip of the skill whose command is nearest; None where the skill has none."""
    gait, frequency = split_name(skill)
    own = [c for c in clips if c.is_steady and c.gait == gait and frequency in (None, c.frequency_hz)]
    return min(own, key=lambda clip: float(np.linalg.norm(clip.command - command)), default=None)


def fit(stride: Floats, position: Floats, cycles: float) -> Floats:
    """The stride (B, J) walked at ``cycles`` strides a step, at the phase that is nearest to the position (T, J)."""
    phase = np.arange(len(position)) * cycles * PHASES
    ring = np.concatenate([stride, stride[:1]])
    shifted = [
        np.stack([np.interp((phase + shift) % PHASES, np.arange(PHASES + 1), column) for column in ring.T], axis=1)
        for shift in range(PHASES)
    ]
    return min(shifted, key=lambda one: float(np.abs(one - position).mean()))


def draw_joints(traces: JointTraces, reference: Mapping[str, ReferenceSummary]) -> Figure:
    """Thigh and calf over time; beside them the tracking of the expert's stride over all evaluated walks."""
    with style():
        figure = new_figure((PAGE, 3.3))
        parts: Any = figure.subfigures(1, 2, width_ratios=(3.6, 1)) if reference else (figure, None)
        wide, narrow = parts
        axes = wide.subplots(2, 1, sharex=True)
        for row, (joint, axis) in enumerate(zip(JOINTS, axes, strict=True)):
            _draw_joint(axis, traces, row)
            axis.set_ylabel(f"{LEG} {joint} (rad)")
        axes[1].set_xlabel("time (s)")
        _name_skills(axes[0], traces.commanded)
        handles, labels = axes[0].get_legend_handles_labels()
        wide.legend(handles, labels, loc="outside lower center", ncols=3)
        wide.align_ylabels(axes)
        if narrow is not None:
            _draw_reference(narrow.subplots(), reference)
    return figure


def _draw_joint(axes: Axes, traces: JointTraces, row: int) -> None:
    colours = skill_colours([span.name for span in traces.commanded])
    for span in traces.commanded:
        axes.axvspan(span.start_s, span.end_s, color=colours[span.name], alpha=0.13, linewidth=0)
    axes.plot(traces.time, traces.expert[:, row], color="#ABABAB", linewidth=2.8, label="expert's mean stride")
    axes.plot(traces.time, traces.target[:, row], color=TARGET, linewidth=0.6, label="target")
    axes.plot(traces.time, traces.actual[:, row], color=ACTUAL, linewidth=0.9, label="actual")
    axes.set_xlim(traces.time[0], traces.time[-1])


def _name_skills(axes: Axes, commanded: Sequence[Span]) -> None:
    for span in commanded:
        place = ((span.start_s + span.end_s) / 2, 1.02)
        look = {"ha": "center", "va": "bottom", "fontweight": "bold", "fontsize": 7.5}
        axes.text(*place, span.name, transform=axes.get_xaxis_transform(), **look)


def _draw_reference(axes: Axes, reference: Mapping[str, ReferenceSummary]) -> None:
    """Accuracy, mean of thigh and calf: policy, standing, and the policy against another gait's clip."""
    rows = [name for name in reference if name != "all" and reference[name].policy]
    if not rows:  # no walk was long enough to be compared
        axes.set_axis_off()
        return
    looks = {"policy": ("o", ACTUAL), "standing": ("s", GREY), "other_gait": ("^", TARGET)}
    for part, (mark, colour) in looks.items():
        found = [getattr(reference[name], part) for name in rows]
        values = [
            100 * float(np.mean([one.accuracy for one in kinds.values()])) if kinds else np.nan for kinds in found
        ]
        axes.plot(values, range(len(rows)), mark, color=colour, markersize=3.5, label=part.replace("_", " "))
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlim(right=100.0)
    axes.grid(axis="x", color=GRID, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.set_xlabel("reference\ntracking (%)")
    axes.legend(loc="lower center", bbox_to_anchor=(0.4, 1.0), ncols=1, handletextpad=0.2, fontsize=7)
