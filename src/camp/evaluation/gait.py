"""Part "gait": does each skill look as it should, judged by measured foot contacts and heights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from camp.evaluation.reading import FELL, Reading
from camp.evaluation.report import ExpertGait, FrictionBin, GaitSummary, PolicySummary, TableI
from camp.evaluation.values import circular_mean, fraction, mean
from camp.gaits.schedule import nominal_duty, nominal_flight
from camp.gaits.skills import NO_SKILL
from camp.metrics.tracking import FAST_COMMAND_M_S
from camp.motion.clips.clip import Clip
from camp.motion.dataset.requests import describe_command


def summarize(reading: Reading) -> PolicySummary:
    """Figures of one policy's walks, per skill and over all."""
    skills = {name: _averages(reading, chosen) for name, chosen in reading.groups()}
    return PolicySummary(
        all=skills.pop("all"),
        skills=skills,
        confusion=_confusion(reading, reading.shown),
        labelled=_confusion(reading, reading.labelled),
    )


def summarize_table_i(reading: Reading, friction: NDArray[np.floating], edges: Sequence[float]) -> TableI:
    """Walks under the whole of Table I, and by the friction (R,) that each robot walked on."""
    index = np.digitize(friction, edges)
    bounds = [None, *edges, None]
    return TableI(
        walks=summarize(reading),
        friction=[
            FrictionBin(
                low=bounds[i],
                high=bounds[i + 1],
                right=fraction(reading.right[index == i]),
                falls=int(reading.fallen[index == i].sum()),
            )
            for i in range(len(edges) + 1)
        ],
    )


def beside_expert(reading: Reading, clips: Sequence[Clip]) -> dict[str, ExpertGait]:
    """Per skill the expert's stride frequency, duty and flight, and how far the policy's frequency is from it.

    The expert's frequency is, for each walk, the skill's own or, where skills have none, that of the clips of its gait
    nearest to the measured one; duty and flight go with it. Averaged over the walks whose rhythm counts.
    """
    result = {}
    for label, skill in enumerate(reading.skills):
        known = np.unique([clip.frequency_hz for clip in clips if skill.includes(clip.gait, clip.frequency_hz)])
        measured = reading.gait.frequency_hz[(reading.wanted == label) & reading.stepping]
        measured = measured[np.isfinite(measured)]
        nearest = known[np.abs(measured[:, None] - known).argmin(axis=1)]
        result[skill.name] = ExpertGait(
            frequency_hz=mean(nearest),
            frequency_error=mean(np.abs(measured / nearest - 1.0)),
            duty=mean(np.array([nominal_duty(skill.gait, hz) for hz in nearest])),
            flight_fraction=mean(np.array([nominal_flight(skill.gait, hz) for hz in nearest])),
        )
    return result


def performed_by_command(reading: Reading, commands: Sequence[Sequence[float]]) -> dict[str, dict[str, str]]:
    """What was shown in each cell of the grid: skill -> command -> skill performed."""
    words = [describe_command((vx, vy, wz)) for vx, vy, wz in commands]
    shown = reading.shown.reshape(len(reading.skills), len(commands))
    return {skill.name: dict(zip(words, shown[k].tolist(), strict=True)) for k, skill in enumerate(reading.skills)}


def _confusion(reading: Reading, found: NDArray[np.str_]) -> dict[str, dict[str, int]]:
    """Commanded skill -> what was found of it (R,) -> walks."""
    outcomes = [*(skill.name for skill in reading.skills), NO_SKILL, FELL]
    return {
        name: {outcome: int((chosen & (found == outcome)).sum()) for outcome in outcomes}
        for name, chosen in reading.groups()
        if name != "all"
    }


def _averages(reading: Reading, chosen: NDArray[np.bool_]) -> GaitSummary:
    gait, error = reading.gait, reading.error
    upright, stepping = chosen & ~reading.fallen, chosen & reading.stepping
    fast = np.hypot(reading.command[:, 0], reading.command[:, 1]) >= FAST_COMMAND_M_S
    return GaitSummary(
        rollouts=int(chosen.sum()),
        falls=int(reading.fallen[chosen].sum()),
        gait_accuracy=fraction(reading.right[chosen]),
        failed={name: int((value & upright).sum()) for name, value in reading.failed.items()},
        stepping=float(reading.stepping[chosen].mean()),
        frequency_hz=mean(gait.frequency_hz[stepping]),
        phase=[circular_mean(gait.phase[stepping, leg]) for leg in range(4)],
        duty=mean(gait.duty[stepping]),
        flight_fraction=mean(gait.flight[stepping]),
        touches_per_stride=mean(gait.touches[stepping]),
        linear_error_m_s=float(error.linear[chosen].mean()),
        linear_error_fast_m_s=mean(error.linear[chosen & fast]),
        yaw_rate_error_rad_s=float(error.angular[chosen].mean()),
    )
