"""Every figure and table by its name: what it is drawn from, and how."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from analysis import load, study_figures
from analysis.clusters import POINTS_PER_SKILL, compute_clusters, draw_clusters, sample_transitions
from analysis.contacts import diagram_of, draw_diagram
from analysis.data_flow import draw_data_flow
from analysis.dtw import compute_distances, draw_distances, mean_distances
from analysis.evaluation_figures import draw_confusion, draw_robustness
from analysis.film_strip import compute_strip, draw_strip
from analysis.incentive import RESULT as INCENTIVE
from analysis.incentive import read_incentives
from analysis.incentive_figure import draw_margins, draw_matrices
from analysis.joints import compute_joints, draw_joints
from analysis.latent_space import RESULT as LATENT_SPACE
from analysis.latent_space import distances_of
from analysis.reports import read_report
from analysis.segments import policy_walks, segment_features
from analysis.sequence import roll_sequence
from analysis.skill_cost import compute_cost, draw_cost
from analysis.study_results import RESULTS, StudyResult, read_result
from analysis.tables import ablation_table, difference_table, narrow_table, seed_table
from analysis.training import compute_curves, draw_curves
from camp.build import Run, load_run
from camp.evaluation.recording import Recording
from camp.evaluation.report import Report
from camp.robots.registry import find_robot

SEED = 0


@dataclass
class Sources:
    """What figures of a run folder are drawn from, read or rolled out when first asked for."""

    folder: Path
    results: Path = RESULTS

    @cached_property
    def run(self) -> Run:
        return load_run(self.folder)

    @cached_property
    def report(self) -> Report:
        return read_report(self.folder)

    @cached_property
    def sequence(self) -> Recording:
        return roll_sequence(self.run, self.folder)

    @cached_property
    def walks(self) -> list[load.ClipFeatures]:
        return policy_walks(self.run, self.folder)

    @cached_property
    def clips(self) -> list[load.ClipFeatures]:
        return load.clip_features(self.run)


def _clusters(sources: Sources) -> Figure:
    skills, generator = sources.run.config.motion.skill_set(), np.random.default_rng(SEED)
    expert = sample_transitions(segment_features(sources.run), POINTS_PER_SKILL, generator, skills)
    policy = sample_transitions(sources.walks, POINTS_PER_SKILL // 2, generator, skills)
    return draw_clusters(compute_clusters(*expert, SEED, policy))


def _dtw(sources: Sources) -> Figure:
    against = compute_distances(sources.walks, sources.clips)
    labels = "gait" if sources.run.config.motion.labels == "gait" else "gait and frequency"
    expert = f"expert's clips, labelled by {labels}"
    panels = {expert: compute_distances(sources.clips), "policy's walks against the expert's": against}
    return draw_distances(panels, ("", "policy"))


def _dtw_expert(sources: Sources) -> Figure:
    path = sources.results / LATENT_SPACE.name
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))["seeds"]
        distances = mean_distances([distances_of(row) for row in rows])
    except (OSError, ValueError, KeyError) as error:
        raise load.AnalysisError(
            f"result {path}: cannot be read ({error}); make it with `python -m analysis.latent_space`"
        ) from error
    title = f"skill discriminator of the expert alone, labelled by gait; mean of {len(rows)} seeds"
    return draw_distances({title: distances})


def _incentive(sources: Sources) -> Figure:
    return draw_matrices(*read_incentives(sources.results / INCENTIVE.name))


def _incentive_margins(sources: Sources) -> Figure:
    return draw_margins(read_incentives(sources.results / INCENTIVE.name)[1])


def _film_strip(sources: Sources) -> Figure:
    robot = find_robot(sources.run.config.robot.name)
    return draw_strip(compute_strip(robot, sources.sequence, sources.run.skills))


def _joints(sources: Sources) -> Figure:
    traces = compute_joints(sources.sequence, sources.run.skills, sources.run.clips)
    return draw_joints(traces, sources.report.reference)


FIGURES: dict[str, Callable[[Sources], Figure]] = {  # by name; the paper's numbers where it has such a figure
    "data_flow": lambda sources: draw_data_flow(sources.run.config),  # Fig. 1
    "training": lambda sources: draw_curves(compute_curves(load.learning_curve(sources.folder))),
    "confusion": lambda sources: draw_confusion(sources.report),
    "robustness": lambda sources: draw_robustness(sources.report),
    "film_strip": _film_strip,  # Fig. 2
    "contacts": lambda sources: draw_diagram(diagram_of(sources.sequence, sources.run.skills)),  # Fig. 6
    "joints": _joints,  # Fig. 5
    "clusters": _clusters,  # Fig. 3
    "dtw": _dtw,  # Fig. 4
    "dtw_expert": _dtw_expert,  # Fig. 4
    "incentive": _incentive,
    "incentive_margins": _incentive_margins,
    "skill_cost": lambda sources: draw_cost(compute_cost(sources.run.config)),
}
STUDY_FIGURES: dict[str, Callable[[StudyResult], Figure]] = {  # one file of each study
    "measures": study_figures.draw_measures,
    "confusion": study_figures.draw_confusions,
    "learning": study_figures.draw_learning,
}


def studies(folder: Path) -> list[StudyResult]:
    """All studies with a result, by name. Raises AnalysisError where there are none, or one is damaged."""
    own = (INCENTIVE.name, LATENT_SPACE.name)
    found = [read_result(path) for path in sorted(folder.glob("*.json")) if path.name not in own]
    if not found:
        raise load.AnalysisError(f"no study's result in '{folder}': run one with `make ablations`")
    return found


def tables(result: StudyResult) -> dict[str, str]:
    """The texts of a study's tables by the ending of their file: Table IV, and every run for a program to read."""
    table, differences = ablation_table(result), difference_table(result)
    both = [table, differences] if differences.rows else [table]
    return {
        "table.md": "\n\n".join(one.as_markdown() for one in both) + "\n",
        "table.tex": narrow_table(result).as_latex(),
        "table.csv": table.as_csv(),
        "seeds.csv": seed_table(result).as_csv(),
    }
