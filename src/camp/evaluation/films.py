"""Videos of what was judged."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from camp.common.errors import CampError
from camp.common.progress import track
from camp.evaluation.config import EvaluationConfig
from camp.evaluation.evaluator import Judgement
from camp.evaluation.robot import ROBOT
from camp.sim.rendering import RobotRenderer, write_video

STEPS_PER_FRAME = 2  # 25 frames per second


def film(judgement: Judgement, skills: Sequence[str], evaluation: EvaluationConfig, folder: Path) -> dict[str, Path]:
    """The mp4s that ``evaluation`` asks for, by name, in ``folder``, which exists.

    Without OpenGL none, and those that cannot be written are left out: a line on stderr says so.
    """
    try:
        renderer = RobotRenderer(ROBOT.load_model())
    except CampError as error:
        print(f"no videos: {error}", file=sys.stderr)
        return {}
    films, grid, switching = {}, judgement.grid, judgement.switching
    if grid is not None and evaluation.video_skills:
        steps = round(evaluation.video_s / grid.period_s)
        rows = {name: k * len(evaluation.commands) + evaluation.video_command for k, name in enumerate(skills)}
        films = {name: (grid.qpos[row, :steps], grid.period_s) for name, row in rows.items()}
    if switching is not None:
        films["switching"] = (switching.qpos[0], switching.period_s)
    written = {}
    for name, (poses, period_s) in films.items():
        path = folder / f"{name}.mp4"
        frames = map(renderer.frame, track(poses[::STEPS_PER_FRAME], f"filming {name}, pictures"))
        try:
            write_video(path, frames, 1.0 / (STEPS_PER_FRAME * period_s))
        except (OSError, RuntimeError) as error:  # imageio reports a missing ffmpeg as RuntimeError
            print(f"no video {path}: {' '.join(str(error).split())}", file=sys.stderr)
            continue
        print(f"wrote {path}", flush=True)
        written[name] = path
    renderer.close()
    return written
