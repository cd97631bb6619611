"""`python -m analysis.side_by_side run=<folder> [seconds=<s>] [output=<file>]`: the gaits side by side, as mp4.

The exported policy walks in the bare loop of `camp.deploy` at 0.6 m/s, once with one skill of each gait, up to four;
each walk is a quarter of the picture, 1280 x 720 pixels at the rate of the control steps, 50 per second. Shown are the
skill, the measured velocity, and the feet's contacts. The walk is seen after it has settled for 2 s. The default is 6
seconds into <folder>/videos/side_by_side.mp4; that of a shipped policy goes into outputs/<its name>/videos.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from analysis.animation import COMMAND
from analysis.load import AnalysisError
from analysis.sequence import one_skill_of_each_gait
from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.common.files import make_folder
from camp.common.progress import track
from camp.deploy import SETTLING_S, walk
from camp.deployment.export import policy_of_run
from camp.deployment.loop import Policy
from camp.evaluation.captions import Take, caption
from camp.metrics.contact import debounced
from camp.robots.registry import find_robot
from camp.runs.folder import VIDEOS, results_folder
from camp.sim.rendering import RobotRenderer, write_video

TILE = (640, 360)  # pixels
TILES = 4
SECONDS, LONGEST_S = 6.0, 60.0


def takes(policy: Policy, seconds: float) -> list[Take]:
    """A settled walk of ``seconds`` with one skill of each gait. Raises AnalysisError where the robot falls."""
    period, found = policy.metadata["control_period"], []
    for skill in one_skill_of_each_gait(policy.metadata["skills"])[:TILES]:
        done = walk(policy, skill, COMMAND, SETTLING_S + seconds)
        if done.fell:
            raise AnalysisError(
                f"the robot fell after {len(done.qpos) * period:.2f} s as {skill}: train the run further"
            )
        seen = slice(round(SETTLING_S / period), None)
        contact = debounced(done.contact[seen], period)
        names = [skill] * len(done.qpos[seen])
        found.append(Take(period, names, np.array(COMMAND), done.velocity[seen], contact, done.qpos[seen]))
    return found


def pictures(shown: Sequence[Take], renderer: RobotRenderer) -> Iterator[np.ndarray]:
    """Frames (720, 1280, 3) uint8, one for each control step: two takes above, two below; a place may stay white."""
    width, height = TILE
    for step in range(len(shown[0].skill)):
        picture = np.full((2 * height, 2 * width, 3), 255, np.uint8)
        for place, take in enumerate(shown):
            top, left = place // 2 * height, place % 2 * width
            picture[top : top + height, left : left + width] = caption(renderer.frame(take.qpos[step]), take, step)
        yield picture


def film(arguments: Sequence[str]) -> None:
    """Carry out the command line and print the file's path. Raises CampError."""
    given = key_values(arguments, required=["run"], optional=["seconds", "output"])
    run, seconds = Path(given["run"]), _seconds(given.get("seconds", str(SECONDS)))
    path = Path(given["output"]) if "output" in given else results_folder(run) / VIDEOS / "side_by_side.mp4"
    policy = policy_of_run(run)
    renderer = RobotRenderer(find_robot(policy.metadata["robot"]).load_model(), *TILE, smooth=True)
    shown = takes(policy, seconds)
    make_folder(path.parent)
    frames = track(pictures(shown, renderer), "filming, pictures", len(shown[0].skill), sys.stderr)
    try:
        write_video(path, frames, 1.0 / shown[0].period_s)
    except (OSError, RuntimeError) as error:  # imageio reports a missing ffmpeg as RuntimeError
        raise ConfigError(
            f"output {path}: {' '.join(str(error).split())}; choose a file that can be written"
        ) from error
    renderer.close()
    print(path)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 0.1 <= seconds <= LONGEST_S:
        raise ConfigError(f"seconds = {text}: give a number from 0.1 to {LONGEST_S:g}")
    return seconds


if __name__ == "__main__":
    sys.exit(run_command(film, sys.argv[1:], __doc__))
