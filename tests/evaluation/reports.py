"""Reports made up, as the judge would write them."""

from __future__ import annotations

from typing import Any

from camp.evaluation.report import (
    FORMAT,
    Estimate,
    FirstSequence,
    GaitSummary,
    Peaks,
    PolicySummary,
    Report,
    SuiteStamp,
    SwitchGroup,
    SwitchingSummary,
    TrackingSummary,
)


def gait_summary(right: Estimate | None, walks: int, falls: int = 0, frequency: float | None = 2.04) -> GaitSummary:
    return GaitSummary(
        rollouts=walks,
        falls=falls,
        gait_accuracy=right,
        failed={"gait": 0},
        stepping=1.0,
        frequency_hz=frequency,
        phase=[0.0, 0.5, 0.5, 0.0],
        duty=0.5,
        flight_fraction=0.0,
        touches_per_stride=1.0,
        linear_error_m_s=0.05,
        linear_error_fast_m_s=None,
        yaw_rate_error_rad_s=0.03,
    )


def policy_summary(skills: dict[str, GaitSummary], falls: int = 0) -> PolicySummary:
    walks = sum(part.rollouts for part in skills.values())
    first = next(iter(skills.values())).gait_accuracy
    return PolicySummary(gait_summary(first, walks, falls), skills, {})


def tracking_summary(linear: Estimate | None, angular: Estimate | None) -> TrackingSummary:
    return TrackingSummary({}, {}, linear, angular)


def switching_summary(completed: Estimate | None, falls: int, sequences: int) -> SwitchingSummary:
    peaks = Peaks(0.5, 6.0)
    group = SwitchGroup(completed.n if completed else 0, completed, 0.4, 0.8, peaks, peaks)
    return SwitchingSummary(sequences, falls, 1.0, group, {}, {}, {}, FirstSequence(False, {}))


def report(**changes: Any) -> Report:
    """A report in which nothing was measured, but for ``changes``."""
    values: dict[str, Any] = {
        "format": FORMAT,
        "suite": SuiteStamp("v1", "a", "b", "c", 0),
        "run": "some_run",
        "variant": "camp",
        "iteration": 400,
        "seed": 0,
        "policy": "0123",
        "skills": ["trot", "pace"],
        "parts": ["gait", "table_i", "switching", "tracking"],
        "duration_s": 8.0,
        "discard_s": 2.0,
        "commands_clipped": False,
        "table_i": None,
        "switching": None,
        "verdict": [],
    }
    empty = ("policies", "expert", "performed", "tracking", "quality", "reference", "style", "robustness")
    return Report(**({name: {} for name in empty} | values | changes))
