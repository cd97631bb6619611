"""Pictures of the robot in each skill of the sequence (paper, Fig. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.contacts import spans
from analysis.style import PAGE, new_figure, skill_colours, style
from camp.evaluation.recording import Recording
from camp.gaits.skills import split_name
from camp.robots.robot import Robot
from camp.sim.rendering import RobotRenderer

FRAMES = 3  # of each skill, evenly over two thirds of a stride
BEFORE_SWITCH_S = 0.6  # the frames begin so long before the skill ends
USUAL_HZ = 2.0  # of skills that have no frequency
SIZE = (480, 400)  # pixels
CROP = slice(40, 440)  # of the picture's width


@dataclass(frozen=True)
class Frame:
    """One picture. image: (H, W, 3) uint8; time_s: of the sequence."""

    skill: str
    time_s: float
    image: NDArray[np.uint8]


def compute_strip(robot: Robot, recording: Recording, skills: Sequence[str]) -> list[Frame]:
    """FRAMES pictures of each skill of the recording's first robot. Raises CampError without off-screen OpenGL."""
    renderer = RobotRenderer(robot.load_model(), *SIZE)
    frames = []
    try:
        for span in spans([skills[int(label)] for label in recording.skill[0]], recording.period_s):
            stride_s = 1.0 / (split_name(span.name)[1] or USUAL_HZ)
            for index in range(FRAMES):
                time_s = span.end_s - BEFORE_SWITCH_S + index * stride_s / FRAMES
                step = min(round(time_s / recording.period_s), recording.steps - 1)
                image = renderer.frame(recording.qpos[0, step])[:, CROP].copy()
                frames.append(Frame(span.name, step * recording.period_s, image))
    finally:
        renderer.close()
    return frames


def draw_strip(frames: Sequence[Frame]) -> Figure:
    """Two skills to a row, their name and time above each picture."""
    columns = 2 * FRAMES
    rows = -(-len(frames) // columns)
    colours = skill_colours(list(dict.fromkeys(frame.skill for frame in frames)))
    with style():
        figure = new_figure((PAGE, rows * PAGE / columns * 1.2))
        figure.set_layout_engine("constrained", w_pad=0.02, h_pad=0.02, wspace=0.0)
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for axis, frame in zip(axes, frames, strict=False):
            axis.imshow(frame.image)
            axis.set(xticks=[], yticks=[])
            axis.spines[:].set_visible(True)
            axis.spines[:].set(color=colours[frame.skill], linewidth=2.0)
            axis.set_title(f"{frame.skill}, {frame.time_s:.2f} s", fontsize=7, pad=3)
        for axis in axes[len(frames) :]:
            axis.set_axis_off()
    return figure
