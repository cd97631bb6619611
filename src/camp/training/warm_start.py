"""Imitation of the expert on perturbed clips, before PPO and as its auxiliary loss."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from camp.algo.imitation import ImitationLoss, imitate
from camp.build import Training
from camp.common import distributed
from camp.common.commands import command
from camp.common.errors import ClipError
from camp.common.files import folder_lock
from camp.common.progress import track
from camp.common.seeding import generator
from camp.config.schema import Config
from camp.gaits import schedule
from camp.gaits.gait import GAITS, GRID_STEPS
from camp.motion import expert
from camp.motion.clips.clip import Clip
from camp.motion.clips.mirror import mirrored
from camp.motion.clips.store import load_clip
from camp.motion.dataset import generate, recording, requests
from camp.motion.dataset.generate import generate_dataset
from camp.motion.dataset.requests import ClipRequest, perturbed_requests
from camp.robots import quadruped
from camp.robots import robot as robot_module
from camp.robots.registry import find_robot
from camp.robots.robot import Robot
from camp.training.imitation_data import imitation_data

START_S = 0.5  # of a perturbed clip: the slowest gait's first stride
PERTURBED_SEED = 1  # of the random commands and the noise; the same clips for every training seed


def warm_start(training: Training, config: Config) -> list[dict[str, float]]:
    """Fit the actor to the expert's answers on perturbed clips; metrics of every epoch.

    The demonstrations are left out: hardly ever off their limit cycle, they teach the clone to fall once it is. Nothing
    happens with ``algo.imitation.epochs = 0``. Perturbed clips that are missing are generated first and kept
    for the next run. Raises ClipError where too few can be had.
    """
    imitation = config.algo.imitation
    if imitation.epochs == 0:
        return []
    data = imitation_data(perturbed_clips(config), config, training.device)
    steps = imitate(training.ppo.actor, data, imitation, generator(config.seed, "imitation", training.device))
    metrics = list(track(steps, "imitating the expert, epochs", imitation.epochs))
    print(f"imitation: {len(data.observation):,} pairs, loss {metrics[-1]['imitation/loss']:.4f}", flush=True)
    return metrics


def keep_imitating(training: Training, config: Config) -> None:
    """Add the imitation loss to PPO's on this rank, where ``algo.imitation.ppo_weight`` asks for it.

    Uses the perturbed clips of the warm start; ranks share ``algo.imitation.batch_size``. Raises ClipError where too
    few can be had, ConfigError where the ranks cannot share it equally.
    """
    imitation = config.algo.imitation
    if imitation.ppo_weight == 0.0:
        return
    data = imitation_data(perturbed_clips(config), config, training.device)
    own = replace(imitation, batch_size=distributed.share("algo.imitation.batch_size", imitation.batch_size))
    training.ppo.auxiliary_loss = ImitationLoss(data, own, training.generators["imitation"])


def perturbed_clips(config: Config) -> list[Clip]:
    """The clips of conf/motion's ``perturbed_folder``, after generating the missing ones.

    With ``motion.mirrored`` each is followed by its mirror image without the start.
    """
    robot, wanted = find_robot(config.robot.name), config.motion
    cells = [(gait, frequency) for gait in wanted.skills for frequency in wanted.frequencies_hz]
    requests = perturbed_requests(wanted.perturbed_clips, PERTURBED_SEED, cells)
    version = _expert_version(robot, wanted.skills)
    folder = Path(wanted.perturbed_folder or Path(config.output_dir) / "motions" / f"perturbed-{version}")
    with folder_lock(folder):  # jobs of a sweep want the same clips
        _generate_missing(robot, requests, folder)
    made = [path for path in (folder / f"{request.name}.npz" for request in requests) if path.is_file()]
    # A few noisy clips end in a fall and are not kept; many would mean that something is wrong.
    if len(made) < 0.7 * len(requests):
        options = {"robot": robot.name, "count": wanted.perturbed_clips, "seed": PERTURBED_SEED, "folder": folder}
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        raise ClipError(
            f"perturbed clips in {folder}: {len(made)} of {len(requests)} could be made; see why with "
            f"`{command('camp.dataset', 'perturbed', *words)}`, or train with run=scratch"
        )
    clips = [load_clip(path) for path in made]
    return [one for clip in clips for one in (clip, _under_way(mirrored(clip)))] if wanted.mirrored else clips


def _generate_missing(robot: Robot, requests: list[ClipRequest], folder: Path) -> None:
    """Generate the clips that are not there. Those that end in a fall are noted, for the next run not to try again."""
    note = folder / "failed.txt"
    failed = set(note.read_text().split()) if note.is_file() else set()
    wanted = [request for request in requests if request.name not in failed]
    if all((folder / f"{request.name}.npz").is_file() for request in wanted):
        return
    outcomes = generate_dataset(robot, wanted, folder, workers=os.cpu_count() or 1)
    with note.open("a") as file:
        for outcome in track(outcomes, f"generating perturbed clips in {folder}", len(wanted)):
            if outcome.status == "failed":
                file.write(f"{outcome.request.name}\n")


def _under_way(clip: Clip) -> Clip:
    """The clip without its start.

    A robot that stands is its own mirror image. Shown to begin with the left foot and with the right one, a clone
    answers with the mean of both and goes on standing.
    """
    first = round(START_S / clip.dt)
    arrays = {name: value for name, value in vars(clip).items() if isinstance(value, np.ndarray)}
    return replace(clip, **{name: rows[first:] for name, rows in arrays.items() if len(rows) == len(clip)})


def _expert_version(robot: Robot, gaits: Sequence[str]) -> str:
    """Eight letters that change with what the clips depend on: the robot, these gaits, the expert and the requests."""
    numbers = {name: value for name, value in vars(robot).items() if name not in ("title", "model_path")}
    modules = (quadruped, robot_module, schedule, requests, generate, recording)
    sources = [robot.model_path, *(Path(str(module.__file__)) for module in modules)]
    sources += sorted(Path(str(expert.__file__)).parent.glob("*.py"))
    timing = [GRID_STEPS, *((name, GAITS[name].phases, dict(GAITS[name].duty)) for name in gaits)]
    content = [repr(numbers).encode(), repr(timing).encode(), *(source.read_bytes() for source in sources)]
    return hashlib.sha256(b"".join(content)).hexdigest()[:8]
