"""`python -m analysis.animation run=<folder> [output=<file>]`: the policy switches through its gaits, as a GIF.

The exported policy walks in the bare loop of `camp.deploy` at 0.6 m/s, with one skill of each gait in turn, at 3 Hz
where there is one. Shown are the commanded skill and the feet's measured contacts of the last two seconds, FL, FR, RL,
RR from above. The default output is <folder>/figures/switching.gif; that of a shipped policy goes into
outputs/<its name>/figures.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from analysis.load import AnalysisError
from analysis.sequence import one_skill_of_each_gait
from analysis.style import INK, skill_colours
from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.common.files import whole_file
from camp.common.progress import track
from camp.deployment.export import policy_of_run
from camp.deployment.loop import Memory, Policy
from camp.deployment.simulated import Robot
from camp.evaluation.captions import stance_bars
from camp.robots.quadruped import FOOT_NAMES
from camp.runs.folder import FIGURES, results_folder
from camp.sim.rendering import RobotRenderer

COMMAND = (0.6, 0.0, 0.0)  # vx, vy in m/s, yaw rate in rad/s
SKILL_S = 2.0  # s of each skill
STEPS_PER_FRAME = 4  # 80 ms, a multiple of the 10 ms in which GIF counts; 6 frames in a stride of 2 Hz
SIZE = (320, 240)  # pixels of the picture
TITLE, BAND, MARGIN = 24, 44, 10  # pixels: height above the picture, height below it, left and right
CONTACTS_S = 2.0  # s of contacts that the band shows
COLOURS = 128  # of the palette that all frames share


@dataclass(frozen=True)
class Demonstration:
    """T control steps of ``period_s`` s through several skills."""

    period_s: float
    skill: list[str]  # T names, as commanded
    qpos: NDArray[np.floating]  # (T, 19)
    contact: NDArray[np.bool_]  # (T, 4) FL, FR, RL, RR


def demonstrate(policy: Policy, robot: Robot, skills: Sequence[str]) -> Demonstration:
    """Walk from where ``robot`` stands, SKILL_S with each of ``skills``. Raises AnalysisError where the robot falls."""
    period, memory = policy.metadata["control_period"], Memory(policy)
    commanded = [skill for skill in skills for _ in range(round(SKILL_S / period))]
    rows = []
    for step, skill in enumerate(commanded):
        robot.hold(memory.target(robot, skill, COMMAND))
        rows.append((robot.data.qpos.copy(), [robot.touches(foot) for foot in FOOT_NAMES]))
        if robot.fallen:
            raise AnalysisError(f"the robot fell after {step * period:.2f} s as {skill}: train the run further")
    qpos, contact = map(np.array, zip(*rows, strict=True))
    return Demonstration(period, commanded, qpos, contact)


def frames(demonstration: Demonstration, renderer: RobotRenderer) -> Iterator[Image.Image]:
    """The pictures, RGB, one for every STEPS_PER_FRAME control steps."""
    colours = skill_colours(list(dict.fromkeys(demonstration.skill)))
    large, small = ImageFont.load_default(15), ImageFont.load_default(9)
    width, height = SIZE
    for step in range(0, len(demonstration.skill), STEPS_PER_FRAME):
        image = Image.new("RGB", (width, TITLE + height + BAND), "white")
        image.paste(Image.fromarray(renderer.frame(demonstration.qpos[step])), (0, TITLE))
        draw = ImageDraw.Draw(image)
        skill = demonstration.skill[step]
        draw.rectangle((0, 0, width, TITLE - 1), fill=colours[skill])
        draw.text((MARGIN, TITLE // 2), f"commanded skill: {skill}", fill="white", font=large, anchor="lm")
        _draw_contacts(draw, demonstration, step, colours)
        for row, foot in enumerate(FOOT_NAMES):
            draw.text((MARGIN, _row_top(row) + 4), foot, fill=INK, font=small, anchor="lm")
        yield image


def _row_top(row: int) -> int:
    return TITLE + SIZE[1] + 3 + 10 * row


def _draw_contacts(draw: ImageDraw.ImageDraw, shown: Demonstration, step: int, colours: dict[str, str]) -> None:
    """Stance bars of the last CONTACTS_S; the present is at the right edge."""
    steps = round(CONTACTS_S / shown.period_s)
    for at, row, begin, end in stance_bars(shown.contact, step, steps, (MARGIN + 20, SIZE[0] - MARGIN)):
        top = _row_top(row)
        draw.rectangle((begin, top, end, top + 7), fill=colours[shown.skill[at]])


def write_gif(path: Path, pictures: Sequence[Image.Image], frame_s: float) -> None:
    """Write an endless GIF whose frames share one palette. Raises ConfigError where it cannot be written."""
    width, height = pictures[0].size
    sample = pictures[:: max(1, len(pictures) // 16)]
    sheet = Image.new("RGB", (width, height * len(sample)))
    for index, picture in enumerate(sample):
        sheet.paste(picture, (0, height * index))
    palette = sheet.quantize(COLOURS)
    indexed = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    try:
        with whole_file(path) as file:
            indexed[0].save(
                file, "GIF", save_all=True, append_images=indexed[1:], duration=round(1000 * frame_s), loop=0
            )
    except OSError as error:
        raise ConfigError(f"output {path}: {error.strerror or error}; choose a file that can be written") from error


def animate(arguments: Sequence[str]) -> None:
    """Carry out the command line and print the file's path. Raises CampError."""
    given = key_values(arguments, required=["run"], optional=["output"])
    run = Path(given["run"])
    path = Path(given["output"]) if "output" in given else results_folder(run) / FIGURES / "switching.gif"
    policy = policy_of_run(run)
    robot = Robot(policy.metadata)
    renderer = RobotRenderer(robot.model, *SIZE)
    shown = demonstrate(policy, robot, one_skill_of_each_gait(policy.metadata["skills"]))
    pictures = -(-len(shown.skill) // STEPS_PER_FRAME)
    drawn = list(track(frames(shown, renderer), "drawing pictures", pictures, sys.stderr))
    write_gif(path, drawn, STEPS_PER_FRAME * shown.period_s)
    renderer.close()
    print(path)


if __name__ == "__main__":
    sys.exit(run_command(animate, sys.argv[1:], __doc__))
