"""What a sample shows: intervals of fractions and means, and whether a target is shown by them. scipy does the work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.floating]

CONFIDENCE = 0.95
RESAMPLES = 2000  # of a bootstrap
Verdict = Literal["shown", "not shown", "missed"]


@dataclass(frozen=True)
class Interval:
    """An estimate with its 95-% interval, from n observations."""

    value: float
    low: float
    high: float
    n: int

    def verdict(self, target: float, at_least: bool) -> Verdict:
        """Is a bound shown to hold, shown to be missed, or neither? The whole interval has to lie on one side."""
        if self.low >= target if at_least else self.high <= target:
            return "shown"
        return "missed" if (self.high < target if at_least else self.low > target) else "not shown"


def fraction_interval(count: int, n: int) -> Interval | None:
    """Wilson's interval of ``count`` in ``n`` independent trials; None for none."""
    return _proportion(count, n, "wilson")


def rare_interval(count: int, n: int) -> Interval | None:
    """Clopper and Pearson's exact interval, for rare events such as falls: 0 in 176 is at most 2.1 in 100."""
    return _proportion(count, n, "exact")


def mean_interval(values: Floats, seed: int = 0) -> Interval | None:
    """Bootstrap interval (bias-corrected and accelerated) of the mean of independent values (n,); None for none."""
    values = np.asarray(values, dtype=np.float64)
    if len(values) == 0:
        return None
    mean = float(values.mean())
    if len(values) < 2 or np.ptp(values) == 0:
        return Interval(mean, mean, mean, len(values))
    found = stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=RESAMPLES,
        batch=200,
        confidence_level=CONFIDENCE,
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return Interval(mean, float(found.low), float(found.high), len(values))


def interquartile_mean(scores: Floats) -> float:
    """Mean of the middle half of all scores (Agarwal et al. 2021)."""
    return float(stats.trim_mean(np.asarray(scores, dtype=np.float64).ravel(), 0.25))


def seeds_interval(scores: Floats, seed: int = 0) -> Interval:
    """Stratified bootstrap interval of the interquartile mean over seeds: scores (S seeds, K skills).

    Each skill's seeds are drawn anew, with replacement (Agarwal et al. 2021, "Deep reinforcement learning at the edge
    of the statistical precipice"): what varies is the seed, never the roll-out. Give five seeds or more.
    """
    scores = np.asarray(scores, dtype=np.float64)
    seeds, skills = scores.shape
    rows = np.random.default_rng(seed).integers(seeds, size=(RESAMPLES, seeds, skills))
    drawn = np.take_along_axis(scores[None], rows, axis=1).reshape(RESAMPLES, -1)
    low, high = np.quantile(stats.trim_mean(drawn, 0.25, axis=1), [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return Interval(interquartile_mean(scores), float(low), float(high), seeds)


def _proportion(count: int, n: int, method: str) -> Interval | None:
    if n == 0:
        return None
    found = stats.binomtest(int(count), int(n)).proportion_ci(CONFIDENCE, method=method)
    return Interval(count / n, float(found.low), float(found.high), int(n))
