"""How far apart must states be to show the stride frequency? ``python -m analysis.transition_ages``.

A small classifier learns from three of every four expert clips which skill a transition belongs to, and is asked about
the others. What it cannot tell, a discriminator of the same transitions cannot reward.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier
from sklearn.preprocessing import StandardScaler

from camp.build import expert_clips
from camp.config.compose import compose_config
from camp.gaits.skills import Skill, label_of
from camp.motion.clips.clip import Clip, amp_state
from camp.motion.clips.sampler import transitions

AGES = ((1, 0), (4, 0), (8, 0), (8, 4, 0), (12, 8, 4, 0))  # control steps
EVERY = 4  # every fourth clip of a skill is kept for the question
NOISE = 0.5  # standard deviations, on the questions: a policy's motion is not quite the expert's


def split(clips: Sequence[Clip], skills: Sequence[Skill]) -> tuple[list[Clip], list[Clip]]:
    """Clips to learn from, and clips to be asked about, of each skill."""
    learned, asked = [], []
    for skill in skills:
        own = [clip for clip in clips if skill.includes(clip.gait, clip.frequency_hz)]
        asked += own[::EVERY]
        learned += [clip for i, clip in enumerate(own) if i % EVERY]
    return learned, asked


def samples(clips: Sequence[Clip], skills: Sequence[Skill], ages: Sequence[int]) -> tuple[NDArray, NDArray]:
    """All transitions (B, F * S) of the clips and their labels (B,)."""
    motion = [transitions(torch.from_numpy(amp_state(clip)), ages).flatten(1).numpy() for clip in clips]
    label = np.array([label_of(clip.gait, clip.frequency_hz, skills) for clip in clips])
    return np.concatenate(motion), np.repeat(label, [len(rows) for rows in motion])


def accuracy(clips: Sequence[Clip], skills: Sequence[Skill], ages: Sequence[int], seed: int) -> tuple[float, float]:
    """Fractions of the asked transitions whose skill, and whose gait, is recognized."""
    learned, asked = split(clips, skills)
    scaler = StandardScaler()
    inputs, labels = samples(learned, skills, ages)
    network = MLPClassifier((64,), batch_size=512, max_iter=6, random_state=seed)  # pyright: ignore[reportArgumentType]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # a few passes are enough, and the same for all
        network.fit(scaler.fit_transform(inputs), labels)
    inputs, labels = samples(asked, skills, ages)
    inputs = np.asarray(scaler.transform(inputs))
    answer = np.asarray(network.predict(inputs + NOISE * np.random.default_rng(seed).standard_normal(inputs.shape)))
    gait = np.array([skill.gait for skill in skills])
    return float((answer == labels).mean()), float((gait[answer] == gait[labels]).mean())


def main() -> None:
    """Print the table for the twelve skills."""
    config = compose_config(["run=scratch", "motion.frequencies_hz=[2.0,3.0,4.0]"])
    clips, skills = expert_clips(config), config.motion.skill_set()
    table = Table(title=f"{len(skills)} skills, clips that were not learned from, noise of {NOISE} standard deviations")
    for heading in ("env.transition_ages", "skill recognized", "gait recognized"):
        table.add_column(heading, justify="right")
    for ages in AGES:
        of_skill, of_gait = accuracy(clips, skills, ages, seed=0)
        table.add_row(str(list(ages)), f"{of_skill:.1%}", f"{of_gait:.1%}")
    Console().print(table)


if __name__ == "__main__":
    main()
