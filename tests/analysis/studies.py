"""A made-up study's result: an arm that obeys and one that shows a single gait whatever is commanded."""

from __future__ import annotations

from analysis.study import Thresholds
from analysis.study_results import RunResult, StudyResult

GAITS = ("trot", "pace", "bound", "pronk")
WALKS = 20  # of each commanded gait


def obedient() -> dict[str, dict[str, int]]:
    """Each command is followed."""
    return {gait: {gait: WALKS} for gait in GAITS}


def collapsed() -> dict[str, dict[str, int]]:
    """Trot, whatever is commanded, and one walk of each that shows no gait."""
    return {gait: {"trot": WALKS - 1, "none": 1} for gait in GAITS}


def run_result(arm: str, seed: int, labelled: dict[str, dict[str, int]]) -> RunResult:
    """One run."""
    return RunResult(
        arm=arm,
        seed=seed,
        iterations=10,
        seconds=12.5,
        suite="short 0",
        right=sum(row.get(gait, 0) for gait, row in labelled.items()),
        labelled=labelled,
        switches_completed=0.9 if arm == "full" else 0.1 + 0.01 * seed,
        linear_error_m_s=0.05 + 0.01 * seed,
        walks=4 * WALKS,
        falls=seed,
        curve_steps=[0.1, 0.2, 0.3],
        curve_accuracy=[0.0, 0.1 * seed, 0.2 + 0.1 * seed],
        origin={},
    )


def study_result() -> StudyResult:
    """Two arms and three seeds."""
    arms = {"full": obedient, "no_conditioning": collapsed}
    return StudyResult(
        study="made_up",
        question="Is it obedient?",
        digest="0",
        thresholds=Thresholds(shown_fraction=0.05, distinct_gaits=4, information_bits=1.0),
        arms=list(arms),
        runs=[run_result(arm, seed, make()) for seed in range(3) for arm, make in arms.items()],
        missing=[],
        origin={},
    )
