"""The paper's claims about the latent skill space, tested without a policy: `python -m analysis.latent_space`.

`python -m analysis.latent_space [seeds=0,1,2] [output=ablations/results/latent_space.json]` trains the skill
discriminator to convergence on the expert's clips alone, skills being gaits and clips of 2, 3 and 4 Hz, and asks about
clips of commands that it has not seen: K-means against the gaits (paper, Fig. 3), DTW distances between gaits at each
frequency (Fig. 4), and whether the paper's two statements about them hold.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from analysis import expert_priors
from analysis.clusters import POINTS_PER_SKILL, Scores, compute_partition, sample_transitions
from analysis.dtw import LatentDistances, compute_distances
from analysis.load import prior_features
from analysis.provenance import provenance
from camp.algo.skill import SkillPrior
from camp.build import expert_clips
from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.common.files import write_text
from camp.common.threads import set_threads
from camp.config.compose import compose_config
from camp.motion.clips.clip import Clip

# The paper's pairs of consecutive states and networks; a greater rate, since nothing moves but the prior.
PRESET = (
    *("motion.labels=gait", "motion.frequencies_hz=[2.0,3.0,4.0]", "motion.num_preloaded=60000", "run=paper"),
    *("sim=cpu", "algo.style.enabled=false", "algo.skill.updates=1"),
    *("algo.skill.batch_size=256", "algo.skill.learning_rate=1e-3"),
)
RESULT = Path("ablations/results/latent_space.json")


@dataclass(frozen=True)
class Claim:
    """A statement of the paper. figures: the distances that it compares."""

    statement: str
    holds: bool
    figures: str

    def __str__(self) -> str:
        return f"{'holds' if self.holds else 'does not hold'}: {self.statement} ({self.figures})"


@dataclass(frozen=True)
class Seed:
    """What one discriminator found. losses: on held-out motion, block by block of training."""

    seed: int
    losses: list[float]
    scores: Scores
    labels: list[str]
    distance: list[list[float]]


def claims(distances: LatentDistances) -> list[Claim]:
    """The paper's two: a gait is nearer to itself at another frequency than to any other gait; and pronk and bound at
    2 Hz are nearer to each other than bound at 2 Hz to bound at 4 Hz."""
    labels, distance = distances.labels, distances.distance
    gait = np.array([label.split("_")[0] for label in labels])
    same = gait[:, None] == gait[None, :]
    own = np.where(same & ~np.eye(len(labels), dtype=bool), distance, np.nan)
    greatest, least = float(np.nanmax(own)), float(distance[~same].min())

    def between(first: str, second: str) -> float:
        return float(distance[labels.index(first), labels.index(second)])

    converged, across = between("pronk_2hz", "bound_2hz"), between("bound_2hz", "bound_4hz")
    return [
        Claim(
            "gaits at any two frequencies are nearer to themselves than to another gait",
            greatest < least,
            f"greatest within a gait {greatest:.1f}, least between gaits {least:.1f}; "
            f"trot_2hz-trot_4hz {between('trot_2hz', 'trot_4hz'):.1f}",
        ),
        Claim(
            "pronk_2hz is nearer to bound_2hz than bound_4hz is",
            converged < across,
            f"pronk_2hz-bound_2hz {converged:.1f}, bound_2hz-bound_4hz {across:.1f}",
        ),
    ]


def measure(seed: int, clips: list[Clip]) -> Seed:
    """Train one discriminator to convergence and ask it about the held-out clips."""
    config = compose_config([*PRESET, f"seed={seed}"])
    shown, (prior,) = expert_priors.show(config, clips), expert_priors.fresh_priors(config)
    assert isinstance(prior, SkillPrior)
    losses = expert_priors.converge(prior, shown, seed)
    asked = expert_priors.split_commands(clips)[1]
    features = [prior_features(prior, clip, config.env.transition_ages) for clip in asked]
    points = sample_transitions(features, POINTS_PER_SKILL, np.random.default_rng(seed), config.motion.skill_set())
    distances = compute_distances(features)
    return Seed(seed, losses, compute_partition(*points, seed).scores, distances.labels, distances.distance.tolist())


def distances_of(row: dict) -> LatentDistances:
    """The distances of one seed in the result's JSON."""
    return LatentDistances(list(row["labels"]), np.array(row["distance"]))


def run(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises ConfigError."""
    given = key_values(arguments, required=[], optional=["seeds", "output"])
    try:
        seeds = [int(seed) for seed in given.get("seeds", "0,1,2").split(",")]
    except ValueError as error:
        raise ConfigError(f"seeds={given['seeds']}: give whole numbers, such as seeds=0,1,2") from error
    set_threads(1)  # the least time for batches this small
    begun, origin, rows = time.perf_counter(), provenance(), []
    clips, path = expert_clips(compose_config(PRESET)), Path(given.get("output", RESULT))
    for seed in seeds:
        found = measure(seed, clips)
        stated = claims(distances_of(asdict(found)))
        print(f"seed {seed}: held-out loss {found.losses[-1]:.4f}; K-means: {found.scores}")
        for claim in stated:
            print(f"  {claim}", flush=True)
        rows.append(asdict(found) | {"claims": [asdict(claim) for claim in stated]})
        result = {"study": "latent_space", "preset": list(PRESET), "seconds": round(time.perf_counter() - begun, 1)}
        write_text(path, json.dumps(result | origin | {"seeds": rows}) + "\n")
    print(f"wrote {path}")


if __name__ == "__main__":
    sys.exit(run_command(run, sys.argv[1:], __doc__))
