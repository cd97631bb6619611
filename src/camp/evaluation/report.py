"""The report of an evaluation, eval.json: every value with its type, written and read by the same classes.

Fractions and means that a target is judged by come with their 95-% interval and sample size. None stands where there
was nothing to measure.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal

from pydantic import TypeAdapter, ValidationError

from camp.common.errors import CampError
from camp.common.files import write_text
from camp.common.foreign import first_problem, foreign_file, read_json
from camp.metrics.statistics import Verdict
from camp.robots.registry import DEFAULT_ROBOT

FORMAT: Literal[2] = 2  # of eval.json; 1 had neither suite nor intervals


class ReportError(CampError):
    """A file is no report of this format."""


@dataclass
class Estimate:
    """A fraction or a mean with its 95-% interval, from n walks or switches."""

    value: float
    low: float
    high: float
    n: int


@dataclass
class SuiteStamp:
    """What decided the figures."""

    name: str  # such as v1, or custom where the values are no named suite's
    digest: str  # of the suite's values
    thresholds: str  # digest of the gait criteria's limits
    model: str  # digest of the robot's model file
    seed: int
    robot: str = DEFAULT_ROBOT  # reports from before there was another name none


@dataclass
class GaitSummary:
    """How some walks look. Errors are those of the mean velocity."""

    rollouts: int
    falls: int
    gait_accuracy: Estimate | None  # walks that are right
    failed: dict[str, int]  # upright walks by the criterion that they fail; one may fail several
    stepping: float
    frequency_hz: float | None
    phase: list[float | None]
    duty: float | None
    flight_fraction: float | None
    touches_per_stride: float | None
    linear_error_m_s: float
    linear_error_fast_m_s: float | None
    yaw_rate_error_rad_s: float


@dataclass
class PolicySummary:
    """One policy's walks: all, by skill, and commanded skill x what was shown, by all criteria (confusion) and by gait
    and stride frequency alone (labelled; empty in older reports)."""

    all: GaitSummary
    skills: dict[str, GaitSummary]
    confusion: dict[str, dict[str, int]]
    labelled: dict[str, dict[str, int]] = field(default_factory=dict)


@dataclass
class ExpertGait:
    """The expert beside the policy: its frequency, duty and flight, and the policy's deviation from the frequency."""

    frequency_hz: float | None
    frequency_error: float | None
    duty: float | None
    flight_fraction: float | None


@dataclass
class FrictionBin:
    """Walks under Table I with a friction in [low, high); an end that is None is the range's."""

    low: float | None
    high: float | None
    right: Estimate | None
    falls: int


@dataclass
class TableI:
    """Walks of robots drawn from the whole of Table I, with sensor noise and pushes."""

    walks: PolicySummary
    friction: list[FrictionBin]


@dataclass
class BinError:
    """Mean errors of the commands in a bin."""

    linear_error_m_s: float
    yaw_rate_error_rad_s: float


@dataclass
class TrackingSummary:
    """Errors in bins of the commanded speed and of the commanded yaw rate, and over all with their intervals."""

    by_speed: dict[str, BinError]
    by_turn: dict[str, BinError]
    linear_error_m_s: Estimate | None
    yaw_rate_error_rad_s: Estimate | None


@dataclass
class QualitySummary:
    """What the motion costs; units in the names."""

    falls_per_minute: float | None
    peak_torque_share: float | None
    torque_at_limit_share: float | None
    joint_near_stop_share: float | None
    joint_speed_peak_share: float | None
    action_rate_rad: float | None
    foot_slip_m_s: float | None
    power_w: float | None
    cost_of_transport: float | None


@dataclass
class JointReference:
    """Tracking of the expert's mean stride by one kind of joint, mean over legs and walks."""

    accuracy: float
    skill: float


@dataclass
class ReferenceSummary:
    """Tracking of the expert's clip of the same skill and command; and what that figure is for other motions."""

    walks: int
    policy: dict[str, JointReference]  # by kind of joint; empty without walks
    standing: dict[str, JointReference]  # the default pose
    other_gait: dict[str, JointReference]  # the policy against the clips of another gait


@dataclass
class StyleSummary:
    """Mean DTW distance to the nearest clip of another command."""

    policy: float | None
    expert_same_skill: float | None
    expert_other_skill: float | None


@dataclass
class Peaks:
    """Mean over switches of the peak in a window."""

    peak_torque_share: float | None
    velocity_jump_rad_s: float | None


@dataclass
class SwitchGroup:
    """Some of the switches."""

    switches: int
    completed: Estimate | None  # within `within_s`
    seconds_median: float | None
    seconds_90_percent: float | None
    at_switch: Peaks
    steady: Peaks


@dataclass
class FirstSequence:
    """The sequence that is filmed and drawn: s until each skill was completed, None for never."""

    fell: bool
    seconds_to_skill: dict[str, float | None]


@dataclass
class SwitchingSummary:
    """Every switch between two skills, by what changes and by the skill switched to."""

    sequences: int
    falls: int
    within_s: float
    all: SwitchGroup
    by_change: dict[str, SwitchGroup]  # gait, frequency, both
    to_skill: dict[str, SwitchGroup]
    pairs: dict[str, float | None]  # completed fraction from each gait to each other one
    first_sequence: FirstSequence


@dataclass
class ConditionSummary:
    """Walks under one disturbance."""

    rollouts: int
    falls: int
    gait_accuracy: Estimate | None
    linear_error_m_s: float
    yaw_rate_error_rad_s: float
    skills: dict[str, float]


@dataclass
class Finding:
    """One target beside what was reached. verdict: by the interval; "missed" where there was nothing to measure."""

    name: str
    target: float
    at_least: bool  # the target is a lower bound; else an upper one
    reached: float | None
    low: float | None
    high: float | None
    n: int
    verdict: Verdict
    note: str = ""


@dataclass
class Report:
    """All that one evaluation found; parts that were not asked for are None or empty."""

    format: Literal[2]
    suite: SuiteStamp
    run: str  # name of the run folder or policy
    variant: str | None
    iteration: int | None
    seed: int | None  # of the training
    policy: str | None  # digest of the judged network's file
    skills: list[str]
    parts: list[str]
    duration_s: float
    discard_s: float
    commands_clipped: bool  # whether the policy's own command range is narrower than the suite's
    policies: dict[str, PolicySummary]
    expert: dict[str, ExpertGait]
    performed: dict[str, dict[str, str]]
    table_i: TableI | None
    tracking: dict[str, TrackingSummary]
    quality: dict[str, QualitySummary]
    reference: dict[str, ReferenceSummary]
    style: dict[str, StyleSummary]
    switching: SwitchingSummary | None
    robustness: dict[str, ConditionSummary]
    verdict: list[Finding]


_ADAPTER = TypeAdapter(Report)


def as_json(report: Report) -> str:
    """The text of eval.json."""
    return _ADAPTER.dump_json(report, indent=2).decode() + "\n"


def as_plain(report: Report) -> dict:
    """The report as nested dicts."""
    return asdict(report)


def write_report(path: Path, report: Report) -> None:
    """Write eval.json whole. Raises ConfigError where the folder cannot be written."""
    write_text(path, as_json(report))


def read_report(path: Path, remedy: str) -> Report:
    """Read eval.json. Raises ReportError in one line for a file that is missing, damaged or of an older format."""
    with foreign_file(path, f"report {path}: cannot be read", remedy, ReportError):
        text = path.read_bytes()
    report = parse_report(text, path, remedy)
    with foreign_file(path, f"report {path}: cannot be used", remedy, ReportError):
        read_json(text)  # whose numbers are finite
    return report


def parse_report(text: bytes, path: Path, remedy: str) -> Report:
    """The report in the text of a file."""
    try:
        return _ADAPTER.validate_json(text)
    except ValidationError as error:
        reason = first_problem(error)
        if reason.startswith("format: "):
            reason = f"of another format than {FORMAT}, by an older or newer judge"
        raise ReportError(f"report {path}: no evaluation's report ({reason}); {remedy}") from error
