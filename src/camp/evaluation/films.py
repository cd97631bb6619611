"""Videos of what was judged."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camp.common.errors import CampError
from camp.common.progress import track
from camp.evaluation.captions import Take, caption
from camp.evaluation.config import EvaluationConfig
from camp.evaluation.evaluator import Judgement
from camp.evaluation.recording import Recording
from camp.robots.robot import Robot
from camp.sim.rendering import RobotRenderer, write_video


@dataclass(frozen=True)
class Quality:
    """Of a film's pictures. width, height: pixels; steps: control steps from one picture to the next."""

    width: int
    height: int
    steps: int
    smooth: bool


USUAL = Quality(640, 480, 2, smooth=False)  # 25 pictures per second
HIGH = Quality(1280, 720, 1, smooth=True)  # 50 pictures per second


def film(
    robot: Robot, judgement: Judgement, skills: Sequence[str], evaluation: EvaluationConfig, folder: Path
) -> dict[str, Path]:
    """The robot's mp4s that ``evaluation`` asks for, by name, in ``folder``, which exists.

    Without OpenGL none, and those that cannot be written are left out: a line on stderr says so.
    """
    quality = HIGH if evaluation.video_high else USUAL
    try:
        renderer = RobotRenderer(robot.load_model(), quality.width, quality.height, quality.smooth)
    except CampError as error:
        print(f"no videos: {error}", file=sys.stderr)
        return {}
    films, grid, switching = {}, judgement.grid, judgement.switching
    if grid is not None and evaluation.video_skills:
        steps = round(evaluation.video_s / grid.period_s)
        rows = {name: k * len(evaluation.commands) + evaluation.video_command for k, name in enumerate(skills)}
        films = {name: take_of(grid, row, skills).until(steps) for name, row in rows.items()}
    if switching is not None:
        films["switching"] = take_of(switching, 0, skills)
    written = {}
    for name, take in films.items():
        path = folder / f"{name}.mp4"
        try:
            frames = pictures(renderer, take, quality.steps, f"filming {name}, pictures")
            write_video(path, frames, 1.0 / (quality.steps * take.period_s))
        except (OSError, RuntimeError) as error:  # imageio reports a missing ffmpeg as RuntimeError
            print(f"no video {path}: {' '.join(str(error).split())}", file=sys.stderr)
            continue
        print(f"wrote {path}", flush=True)
        written[name] = path
    renderer.close()
    return written


def take_of(recording: Recording, robot: int, skills: Sequence[str]) -> Take:
    """What one of the robots did. skills: names of the labels."""
    names = [skills[int(label)] for label in recording.skill[robot]]
    seen = (recording.velocity[robot], recording.step_contact[robot], recording.qpos[robot])
    return Take(recording.period_s, names, recording.command[robot], *seen)


def pictures(renderer: RobotRenderer, take: Take, every: int, what: str) -> Iterator[np.ndarray]:
    """Frames (height, width, 3) uint8 with captions, one for every ``every`` control steps. what: for the progress."""
    for step in track(range(0, len(take.skill), every), what):
        yield caption(renderer.frame(take.qpos[step]), take, step)
