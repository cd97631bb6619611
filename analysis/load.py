"""What the figures read from a run folder: metrics, measured contacts and the skill discriminator's features."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray

from camp.algo.skill import SkillPrior
from camp.common.errors import CampError
from camp.common.histogram import BINS
from camp.data import Transition
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import Clip, discriminator_state
from camp.motion.clips.sampler import transitions
from camp.runs.folder import ARRAYS, METRICS, results_folder
from camp.runs.metrics import read_metrics

if TYPE_CHECKING:  # camp.build imports the simulator, which figures drawn from arrays do not need
    from camp.build import Run

HISTOGRAM = "histogram"  # in the keys of metrics that are one


class AnalysisError(CampError):
    """A run folder lacks what a figure is drawn from."""


class NoLatentSpaceError(AnalysisError):
    """The run is an ablation without a skill discriminator, so it has no latent space to draw."""


@dataclass(frozen=True)
class SwitchingSequence:
    """The evaluation's roll-out through all skills, T control steps.

    period_s: s; skills: names by label; contact: (T, 4) bool, FL, FR, RL, RR; skill: (T,) label commanded at
    each step.
    """

    period_s: float
    skills: tuple[str, ...]
    contact: NDArray[np.bool_]
    skill: NDArray[np.integer]


@dataclass(frozen=True)
class ClipFeatures:
    """One expert clip of constant command as the skill discriminator sees it.

    command: (3,) vx, vy in m/s, wz in rad/s; feature: (T - A, Z), z_hat of every transition (paper eq. 5);
    touchdown: row of the first touchdown of the front left foot, where its strides begin; period_s: s between
    rows.
    """

    gait: str
    frequency_hz: float
    command: NDArray[np.floating]
    feature: NDArray[np.floating]
    touchdown: int
    period_s: float


def newest_run(outputs: Path) -> Path:
    """The folder below `outputs` whose evaluation was written last; AnalysisError where there is none."""
    found = sorted(outputs.glob(f"**/{ARRAYS}"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise AnalysisError(f"no {ARRAYS} below '{outputs}': run `python -m camp.evaluate run=<folder>` first")
    return found[-1].parent


def evaluation_folder(run: Path) -> Path:
    """Where the run's evaluation lies: for a shipped policy the user's own where there is one, else the shipped one."""
    own = results_folder(run)
    return own if (own / ARRAYS).is_file() else run


def learning_curve(folder: Path) -> list[dict[str, Any]]:
    """The rows of a run folder's metrics.jsonl, whole or condensed as a shipped policy's are; at least one.

    Raises CheckpointError where they cannot be read, AnalysisError where there are none or wrong ones.
    """
    rows = [row for row in read_metrics(folder / METRICS) if row.get("steps")]
    for row in rows:
        for key, value in row.items():
            if value is not None and not (_is_histogram if HISTOGRAM in key else _is_number)(value):
                raise AnalysisError(
                    f"'{folder / METRICS}' holds {key} = {value!r} at iteration {row['iteration']}, which is no "
                    f"{'histogram' if HISTOGRAM in key else 'number'}: restore the file or remove that line"
                )
    if not rows:
        raise AnalysisError(f"'{folder / METRICS}' holds no iteration: train the run further")
    return rows


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and isfinite(value)


def _is_histogram(value: Any) -> bool:
    return isinstance(value, list) and len(value) == BINS and all(map(_is_number, value))


def clip_features(run: Run) -> list[ClipFeatures]:
    """Skill-discriminator features of the run's expert clips, without those whose command changes on the way.

    Raises NoLatentSpaceError for a run without a skill discriminator.
    """
    if run.skill_prior is None:
        return features_of(run, [])
    return features_of(run, [clip for clip in run.clips if clip.is_steady])


def features_of(run: Run, clips: Sequence[Clip]) -> list[ClipFeatures]:
    """Features of clips of constant command by the run's skill discriminator. Raises NoLatentSpaceError."""
    if run.skill_prior is None:
        raise NoLatentSpaceError(
            "the run has no skill discriminator and so no latent space: choose a run trained with one"
        )
    return [prior_features(run.skill_prior, clip, run.config.env.transition_ages) for clip in clips]


def prior_features(prior: SkillPrior, clip: Clip, ages: Sequence[int]) -> ClipFeatures:
    """What a skill discriminator sees in a clip of constant command; the only place where figures touch networks."""
    state = torch.from_numpy(discriminator_state(clip)).to(prior.embedding.weight.device)
    shown = transitions(state, ages)
    unread = torch.zeros(len(shown), dtype=torch.int64, device=shown.device)
    return ClipFeatures(
        gait=clip.gait,
        frequency_hz=clip.frequency_hz,
        command=np.asarray(clip.command, dtype=np.float64),
        feature=prior.predict(Transition(state=shown, skill=unread)).cpu().numpy(),
        touchdown=first_touchdown(clip.foot_contact[ages[0] - 1 :, 0]),
        period_s=clip.dt,
    )


def gaits_of(clips: list[ClipFeatures]) -> list[str]:
    """Names of the gaits that occur, in the order of GAIT_PHASES, others behind."""
    return in_order([clip.gait for clip in clips])


def in_order(gaits: Sequence[str]) -> list[str]:
    """Each gait once, in the order of GAIT_PHASES, others behind."""
    return sorted(dict.fromkeys(gaits), key=lambda gait: [*GAIT_PHASES, gait].index(gait))


def first_touchdown(contact: NDArray[np.bool_]) -> int:
    """First row at which one foot's contact (T,) begins; 0 where it never does."""
    begins = np.flatnonzero(contact[1:] & ~contact[:-1])
    return int(begins[0]) + 1 if len(begins) else 0
