"""The expert's motions: contacts, joints, body and speed of the shipped clips, one figure per gait.

`python -m analysis.motions [FOLDER] [TARGET]` draws the clips of FOLDER (default: the shipped ones) into TARGET
(default: docs/motions) and prints the paths.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.contacts import spans
from analysis.load import AnalysisError
from analysis.style import GAIT_COLOURS, INK, PAGE, new_figure, save, style
from camp.cli.key_values import run_command
from camp.common.commands import command
from camp.common.paths import shipped_motions
from camp.gaits.gait import GAITS
from camp.motion.clips.clip import Clip
from camp.motion.clips.consistency import rotation_matrix
from camp.motion.clips.store import load_clip
from camp.motion.dataset.validate import heading_velocity
from camp.robots.quadruped import FOOT_NAMES
from camp.robots.registry import DEFAULT_ROBOT

SHOWN_COMMAND = "forward_0.6"  # of the steady clips that are drawn
SHOWN_S = 1.0  # of a steady clip
EXAMPLES = {  # clip: what it shows
    "trot_3hz_speeding_up": "speeding up (varied)",
    "pace_3hz_changing_00001": "changing commands (varied)",
    "bound_3hz_pushed_00001": "two pushes (recovery)",
    "pronk_to_trot_2hz_forward_0.3": "pronk to trot (transition)",
}
_JOINT_STYLES = {"hip": ":", "thigh": "-", "calf": "--"}
_AXES = {"forward": "-", "left": "--", "turning": ":"}
_COMMAND_GREY = "#999999"


@dataclass(frozen=True)
class MotionTraces:
    """T rows of a clip, as drawn. contact: (T, 4) bool; joint: (T, 3) rad, front left hip, thigh, calf; height: (T,)
    m; pitch: (T,) rad, nose down positive; velocity, command: (T, 3) in m/s and rad/s, heading frame."""

    title: str
    gait: NDArray[np.str_]  # (T,)
    time: NDArray[np.floating]  # (T,) s
    contact: NDArray[np.bool_]
    joint: NDArray[np.floating]
    height: NDArray[np.floating]
    pitch: NDArray[np.floating]
    velocity: NDArray[np.floating]
    command: NDArray[np.floating]


def compute_traces(clip: Clip, title: str, duration_s: float | None = None) -> MotionTraces:
    """The first `duration_s` of a clip, or all of it."""
    rows = len(clip) if duration_s is None else min(len(clip), round(duration_s / clip.dt) + 1)
    rotation = rotation_matrix(clip.base_quaternion[:rows])
    before = clip.previous_gait or clip.gait
    return MotionTraces(
        title=title,
        gait=np.where(np.arange(rows) < clip.switch_step, before, clip.gait),
        time=np.arange(rows) * clip.dt,
        contact=clip.foot_contact[:rows],
        joint=clip.joint_position[:rows, :3],
        height=clip.base_position[:rows, 2],
        pitch=-np.arcsin(np.clip(rotation[:, 2, 0], -1.0, 1.0)),
        velocity=heading_velocity(clip)[:rows],
        command=np.broadcast_to(clip.command, (len(clip), 3))[:rows],
    )


def draw_gait(gait: str, columns: list[MotionTraces]) -> Figure:
    """One column per stride frequency: contacts, joints of the front left leg, height and pitch, speed."""
    with style():
        figure = new_figure((PAGE, 7.0))
        axes = figure.subplots(5, len(columns), sharex="col", sharey="row", squeeze=False)
        for column, traces in enumerate(columns):
            _draw_contacts(axes[0, column], traces)
            _draw_joints(axes[1, column], traces)
            _draw_line(axes[2, column], traces, traces.height)
            _draw_line(axes[3, column], traces, np.degrees(traces.pitch))
            _draw_speed(axes[4, column], traces)
            axes[0, column].set_title(traces.title)
            axes[4, column].set_xlabel("time (s)")
        labels = ("feet on the floor", "front left joints (rad)", "base height (m)", "base pitch (°)", "speed (m/s)")
        for row, label in enumerate(labels):
            axes[row, 0].set_ylabel(label)
        for row in (1, 4):
            handles, names = axes[row, -1].get_legend_handles_labels()
            axes[row, -1].legend(handles, names, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
        figure.align_ylabels(axes[:, 0])
        figure.suptitle(f"{gait}: steady clips, command forward 0.6 m/s", fontsize=10)
    return figure


def draw_examples(examples: list[MotionTraces]) -> Figure:
    """One row per clip that is not steady: contacts above, speed and turning against the command below."""
    with style():
        figure = new_figure((PAGE, 7.0))
        axes = figure.subplots(2 * len(examples), 1, height_ratios=[2, 3] * len(examples), squeeze=False)[:, 0]
        for index, traces in enumerate(examples):
            feet, speed = axes[2 * index], axes[2 * index + 1]
            _draw_contacts(feet, traces)
            feet.set_title(traces.title, loc="left")
            feet.tick_params(axis="x", labelbottom=False)
            _draw_speed(speed, traces, with_turning=True)
            speed.set_ylabel("m/s, rad/s")
        axes[-1].set_xlabel("time (s)")
        axes[1].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    return figure


def _draw_contacts(axes: Axes, traces: MotionTraces) -> None:
    period = traces.time[1] - traces.time[0]
    for run in spans(traces.gait.tolist(), period):
        axes.axvspan(run.start_s, run.end_s, color=GAIT_COLOURS.get(run.name, _COMMAND_GREY), alpha=0.22, linewidth=0)
    for foot in range(len(FOOT_NAMES)):
        stance = spans(np.where(traces.contact[:, foot], "stance", "swing").tolist(), period)
        bars = [(span.start_s, span.end_s - span.start_s) for span in stance if span.name == "stance"]
        axes.broken_barh(bars, (foot - 0.32, 0.64), facecolor=INK, linewidth=0)
    axes.set_yticks(range(len(FOOT_NAMES)), FOOT_NAMES)
    axes.set_ylim(len(FOOT_NAMES) - 0.5, -0.5)
    axes.set_xlim(0.0, traces.time[-1])
    axes.tick_params(axis="y", length=0)


def _draw_joints(axes: Axes, traces: MotionTraces) -> None:
    for index, (joint, line) in enumerate(_JOINT_STYLES.items()):
        axes.plot(traces.time, traces.joint[:, index], line, color=_colour(traces), linewidth=1.0, label=joint)


def _draw_line(axes: Axes, traces: MotionTraces, values: NDArray[np.floating]) -> None:
    axes.plot(traces.time, values, color=_colour(traces), linewidth=1.0)


def _draw_speed(axes: Axes, traces: MotionTraces, with_turning: bool = False) -> None:
    for index, (name, line) in enumerate(_AXES.items()):
        if index == 2 and not with_turning:
            continue
        axes.plot(traces.time, traces.velocity[:, index], line, color=_colour(traces), linewidth=1.0, label=name)
        label = "command" if index == 0 else None
        axes.plot(traces.time, traces.command[:, index], line, color=_COMMAND_GREY, linewidth=0.8, label=label)
    axes.set_xlim(0.0, traces.time[-1])


def _colour(traces: MotionTraces) -> str:
    return GAIT_COLOURS.get(str(traces.gait[-1]), INK)


def draw_motions(folder: Path, target: Path) -> list[Path]:
    """Write <gait>.png for every gait and examples.png; AnalysisError where a clip is missing."""
    paths = []
    for gait in GAITS.values():
        columns = []
        for frequency in gait.duty:
            clip = _clip(folder, f"{gait.name}_{frequency:g}hz_{SHOWN_COMMAND}")
            columns.append(compute_traces(clip, f"{frequency:g} Hz", SHOWN_S))
        paths.append(save(draw_gait(gait.name, columns), target / f"{gait.name}.png"))
    examples = [compute_traces(_clip(folder, name), title) for name, title in EXAMPLES.items()]
    return [*paths, save(draw_examples(examples), target / "examples.png")]


def _clip(folder: Path, name: str) -> Clip:
    path = folder / f"{name}.npz"
    if not path.is_file():
        raise AnalysisError(
            f"'{path}' does not exist: generate it with `{command('camp.dataset', '--folder', str(folder))}`"
        )
    return load_clip(path)


def draw_all(arguments: Sequence[str]) -> None:
    """Draw the figures and print their paths. Raises AnalysisError, ClipError."""
    folder = Path(arguments[0]) if arguments else shipped_motions(DEFAULT_ROBOT)
    target = Path(arguments[1]) if len(arguments) > 1 else Path("docs/motions")
    for path in draw_motions(folder, target):
        print(path)


def main(arguments: list[str]) -> int:
    """Draw the figures; returns the exit code, 2 where a line on stderr says what is missing."""
    return run_command(draw_all, arguments, __doc__)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
