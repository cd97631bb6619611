"""What an ablation is measured by, from counts of commanded x shown skills, and what differs between arms.

A sample is a training seed, never a walk: intervals are bootstrapped over seeds, and arms are compared seed by seed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from camp.gaits.skills import NO_SKILL, split_name
from camp.metrics.statistics import Interval, mean_interval

Counts = NDArray[np.integer]
Confusion = Mapping[str, Mapping[str, int]]  # commanded skill -> what was shown -> walks


def gait_counts(confusion: Confusion) -> tuple[list[str], list[str], Counts]:
    """Commanded gaits, shown gaits with "none" last, and their walks (C, S). Stride frequencies are put together."""
    commanded = list(dict.fromkeys(split_name(skill)[0] for skill in confusion))
    shown = [*commanded, NO_SKILL]
    counts = np.zeros((len(commanded), len(shown)), dtype=int)
    for skill, row in confusion.items():
        for name, walks in row.items():
            gait = split_name(name)[0]
            counts[commanded.index(split_name(skill)[0]), shown.index(gait if gait in shown else NO_SKILL)] += walks
    return commanded, shown, counts


def information(counts: Counts) -> float:
    """Bits that the gait shown tells about the gait commanded, (C, C + 1) walks with "none" last; log2 C at most.

    A walk that shows no gait tells nothing, even if one command ends so more often than others: the mutual information
    of the walks that show one counts by their share. Raises ValueError for no walk.
    """
    shown = counts[:, :-1]
    if np.sum(counts) > 0 and np.sum(shown) == 0:
        return 0.0
    return mutual_information(shown) * float(np.sum(shown) / np.sum(counts))


def mutual_information(counts: Counts) -> float:
    """Bits that a column tells about the row, (C, S) walks: 0 where it tells nothing, log2 C at most.

    The plug-in estimate of the joint frequencies; it is too great by about (C - 1)(S - 1) / (2 ln 2 n) bits for n
    walks. Raises ValueError for no walk.
    """
    walks = np.asarray(counts, dtype=np.float64)
    if walks.sum() <= 0.0:
        raise ValueError("no walk: there is nothing to be told")
    joint = walks / walks.sum()
    independent = joint.sum(axis=1, keepdims=True) * joint.sum(axis=0, keepdims=True)
    told = joint > 0.0
    return float(max(0.0, (joint[told] * np.log2(joint[told] / independent[told])).sum()))


def distinct_gaits(counts: Counts, least_fraction: float) -> int:
    """How many gaits are shown in ``least_fraction`` of all walks or more, whatever was commanded."""
    fractions = np.asarray(counts)[:, : len(counts)].sum(axis=0) / np.sum(counts)
    return int((fractions >= least_fraction).sum())


def over_seeds(values: Mapping[int, float]) -> Interval | None:
    """Mean of an arm's figures by seed, with its bootstrap interval; None without any."""
    return mean_interval(np.array(list(values.values())))


def paired_difference(arm: Mapping[int, float], reference: Mapping[int, float]) -> Interval | None:
    """Mean of arm less reference over the seeds that both have, with its bootstrap interval; None without any.

    Pairing takes out what the seed does to both.
    """
    shared = sorted(arm.keys() & reference.keys())
    return mean_interval(np.array([arm[seed] - reference[seed] for seed in shared]))


def answer(found: Interval | None, threshold: float) -> str:
    """Yes where the whole interval reaches the threshold, No where none of it does, else open."""
    if found is None:
        return "-"
    verdict = found.verdict(threshold, at_least=True)
    return {"shown": "Yes", "missed": "No", "not shown": "open"}[verdict]


def pooled(several: Sequence[Counts]) -> Counts:
    """All seeds' walks together."""
    return np.sum(several, axis=0)
