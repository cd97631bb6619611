"""`python -m analysis [run=<folder>] [only=training|contacts|latent_space]`: draw a run's four figures, or those of one
kind, into <folder>/figures and print their paths. Those of a shipped policy go into outputs/<its name>/figures."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analysis import load
from analysis.clusters import POINTS_PER_SKILL, compute_clusters, draw_clusters, sample_transitions
from analysis.contacts import compute_diagram, draw_diagram
from analysis.dtw import compute_distances, draw_distances
from analysis.style import save
from analysis.training import compute_curves, draw_curves
from camp.build import load_run
from camp.cli.key_values import run_command
from camp.common.files import make_folder
from camp.common.paths import policies_root
from camp.common.progress import phase
from camp.runs.folder import FIGURES, results_folder

SEED = 0


def draw_training(folder: Path) -> list[Path]:
    """Write training.png from the run folder's metrics."""
    training = compute_curves(load.learning_curve(folder))
    return [save(draw_curves(training), figures_folder(folder) / "training.png")]


def draw_contacts(folder: Path) -> list[Path]:
    """Write contacts.png from the run folder's evaluation."""
    diagram = compute_diagram(load.switching_sequence(load.evaluation_folder(folder)))
    return [save(draw_diagram(diagram), figures_folder(folder) / "contacts.png")]


def draw_latent_space(folder: Path) -> list[Path]:
    """Write clusters.png and dtw.png from the run's skill discriminator and expert clips."""
    with phase("reading the expert's clips", stream=sys.stderr):
        run = load_run(folder)
        clips, skills = load.clip_features(run), run.config.motion.skill_set()
    feature, skill = sample_transitions(clips, POINTS_PER_SKILL, np.random.default_rng(SEED), skills)
    with phase(f"t-SNE and K-means of {len(feature)} transitions", stream=sys.stderr):
        clusters = compute_clusters(feature, skill, SEED)
    with phase("DTW distances between the skills", stream=sys.stderr):
        distances = compute_distances(clips)
    return [
        save(draw_clusters(clusters), figures_folder(folder) / "clusters.png"),
        save(draw_distances(distances), figures_folder(folder) / "dtw.png"),
    ]


def figures_folder(folder: Path) -> Path:
    """Where the run's figures go."""
    return results_folder(folder) / FIGURES


def run_folder(arguments: Sequence[str]) -> Path:
    """The folder of `run=<folder>`, or the newest evaluated run below outputs/ without arguments."""
    if not arguments:
        newest = load.newest_run(Path("outputs"))
        shipped = policies_root() / newest.name
        return shipped if shipped.is_dir() and results_folder(shipped) == newest else newest
    key, _, value = arguments[0].partition("=")
    if len(arguments) > 1 or key != "run" or not value:
        raise load.AnalysisError(f"cannot use '{' '.join(arguments)}': call `python -m analysis run=<folder>`")
    folder = Path(value)
    if not folder.is_dir():
        raise load.AnalysisError(f"run folder '{folder}' does not exist: pass one that camp.train wrote")
    return folder


def draw_figures(arguments: Sequence[str]) -> None:
    """Draw all figures and print their paths. Raises CampError where something is missing.

    Learning curves come first: they need no evaluation. What takes its time says so on stderr.
    """
    kinds = {"training": draw_training, "contacts": draw_contacts, "latent_space": draw_latent_space}
    only = [argument.removeprefix("only=") for argument in arguments if argument.startswith("only=")]
    unknown = [kind for kind in only if kind not in kinds]
    if unknown:
        raise load.AnalysisError(f"only={unknown[0]}: no such figures; choose one of {', '.join(kinds)}")
    folder = run_folder([argument for argument in arguments if not argument.startswith("only=")])
    make_folder(figures_folder(folder))  # before any work
    try:
        for draw in [kinds[kind] for kind in only or kinds]:
            for path in draw(folder):
                print(path)
    except load.NoLatentSpaceError as absent:
        print(f"clusters.png and dtw.png left out: {absent}", file=sys.stderr)


def main(arguments: list[str]) -> int:
    """Draw the figures; returns the exit code, 2 where a line on stderr says what is missing."""
    return run_command(draw_figures, arguments, __doc__)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
