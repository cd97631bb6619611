"""Does the sample show that the targets are met?"""

from __future__ import annotations

from camp.evaluation.config import TargetsConfig
from camp.evaluation.report import Estimate, Finding, Report
from camp.evaluation.values import estimate
from camp.metrics.statistics import Interval, rare_interval


def judge_targets(report: Report, targets: TargetsConfig) -> list[Finding]:
    """The targets whose part has been evaluated, those of the headline condition beside the nominal ones."""
    trained, switching, findings = report.policies.get("trained"), report.switching, []
    if trained is not None and "gait" in report.parts:
        accuracy = {name: part.gait_accuracy for name, part in trained.skills.items() if part.gait_accuracy}
        weakest = min(accuracy, key=lambda name: (accuracy[name].value, accuracy[name].low))
        findings.append(
            _finding("gait accuracy", targets.gait_accuracy, accuracy[weakest], True, f"weakest skill: {weakest}")
        )
    if report.table_i is not None:
        walks = report.table_i.walks.all
        note = f"all skills; {walks.falls} of {walks.rollouts} fall"
        findings.append(_finding("gait accuracy, Table I", targets.table_i_accuracy, walks.gait_accuracy, True, note))
    if switching is not None and switching.all.completed is not None:  # one skill alone has nothing to switch to
        note = f"within {switching.within_s:g} s"
        findings.append(_finding("switches completed", targets.switches_completed, switching.all.completed, True, note))
    findings += _falls(report, targets.falls_per_100_episodes)
    if "all" in report.tracking:
        errors = report.tracking["all"]
        findings.append(
            _finding("velocity error, m/s", targets.linear_error_m_s, errors.linear_error_m_s, False, "mean over walks")
        )
        findings.append(
            _finding(
                "yaw rate error, rad/s",
                targets.yaw_rate_error_rad_s,
                errors.yaw_rate_error_rad_s,
                False,
                "mean over walks",
            )
        )
    return findings


def _falls(report: Report, target: float) -> list[Finding]:
    """Falls among the walks without disturbance, where there were any."""
    counts = []
    if "trained" in report.policies and "gait" in report.parts:
        walks = report.policies["trained"].all
        counts.append((walks.falls, walks.rollouts))
    if report.switching is not None:
        counts.append((report.switching.falls, report.switching.sequences))
    falls, episodes = (sum(column) for column in zip(*counts, strict=True)) if counts else (0, 0)
    found = rare_interval(falls, episodes)
    if found is None:
        return []
    hundred = Interval(100 * found.value, 100 * found.low, 100 * found.high, episodes)
    return [_finding("falls per 100 episodes", target, estimate(hundred), False, f"{falls} in {episodes}")]


def _finding(name: str, target: float, found: Estimate | None, at_least: bool, note: str) -> Finding:
    if found is None:
        return Finding(name, target, at_least, None, None, None, 0, "missed", note)
    interval = Interval(found.value, found.low, found.high, found.n)
    verdict = interval.verdict(target, at_least)
    return Finding(name, target, at_least, found.value, found.low, found.high, found.n, verdict, note)
