"""Before CAMP begins: imitation of the expert on clips that show it recovering."""

from __future__ import annotations

import os
from pathlib import Path

from rich.progress import Progress, track

from camp.algo.imitation import imitate
from camp.build import Training
from camp.config import Config
from camp.errors import ClipError
from camp.imitation_data import imitation_data
from camp.motion.clips import Clip, load_clip
from camp.motion.generate import generate_dataset
from camp.motion.requests import perturbed_requests
from camp.seeding import generator

PERTURBED_SEED = 1  # of the random commands and the noise; the same clips for every training seed


def warm_start(training: Training, config: Config) -> dict[str, float]:
    """Fit the actor to the expert's answers, perturbed clips included; metrics of the last epoch.

    Nothing happens with ``algo.imitation.epochs = 0``. Perturbed clips that are missing are generated first and kept
    for the next run. Raises ClipError where too few can be had.
    """
    imitation = config.algo.imitation
    if imitation.epochs == 0:
        return {}
    clips = [*training.clips, *perturbed_clips(config)]
    data = imitation_data(clips, config, training.device)
    steps = imitate(training.ppo.actor, data, imitation, generator(config.seed, "imitation", training.device))
    metrics = list(track(steps, "imitating the expert", total=imitation.epochs))[-1]
    print(f"imitation: {len(data.observation):,} pairs, loss {metrics['imitation/loss']:.4f}", flush=True)
    return metrics


def perturbed_clips(config: Config) -> list[Clip]:
    """The clips of conf/motion's ``perturbed_folder``, after generating the missing ones."""
    motion = config.motion
    folder = Path(motion.perturbed_folder or Path(config.output_dir) / "motions" / "perturbed")
    folder.mkdir(parents=True, exist_ok=True)
    requests = [r for r in perturbed_requests(motion.perturbed_clips, PERTURBED_SEED) if r.gait in motion.skills]
    with Progress() as progress:
        task = progress.add_task(f"perturbed clips in {folder}", total=len(requests))
        for _ in generate_dataset(requests, folder, workers=os.cpu_count() or 1):
            progress.advance(task)
    made = [path for path in (folder / f"{request.name}.npz" for request in requests) if path.is_file()]
    # A few noisy clips end in a fall and are not kept; many would mean that something is wrong.
    if len(made) < 0.7 * len(requests):
        raise ClipError(
            f"perturbed clips in {folder}: {len(made)} of {len(requests)} could be made; "
            "see why with `python -m camp.dataset perturbed`, or train with algo.imitation.epochs=0"
        )
    return [load_clip(path) for path in made]
