"""The report as printed: one table per part, units in the headings, samples and intervals beside the figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rich.console import Group
from rich.table import Table

from camp.common.markdown import pipe_table
from camp.evaluation.cells import cell, fitted, fraction_cells, of_estimate, percent, table, worst_first
from camp.evaluation.motion_tables import reference_table, robustness_table, switching_table
from camp.evaluation.report import (
    Finding,
    GaitSummary,
    PolicySummary,
    QualitySummary,
    Report,
    StyleSummary,
    TableI,
    TrackingSummary,
)

VERDICTS = ("missed", "not shown", "shown")  # in the order of the printed table
WORST = 6  # disturbances that are printed unless all are asked for


def printed(report: Report, width: int, everything: bool = True) -> Group:
    """The report's tables, in ``width`` characters: the verdict, and what it is about; or ``everything``.

    Failures and the worst rows come first.
    """
    tables: list[Table] = []
    if report.verdict:
        title = f"verdict, suite {report.suite.name} ({report.suite.digest}), {report.suite.robot}"
        tables.append(verdict_table(sorted(report.verdict, key=lambda one: VERDICTS.index(one.verdict)), title))
    if report.policies:
        tables.append(_gaits(report))
    if report.table_i is not None:
        tables.append(_table_i(report.table_i))
    if report.switching is not None:
        tables.append(switching_table(report.switching))
    if report.robustness:
        tables.append(robustness_table(report.robustness, None if everything else WORST))
    if everything:
        tables += _further(report)
    return Group(*(part for whole in tables for part in fitted(whole, width)))


def _further(report: Report) -> list[Table]:
    """What explains the figures."""
    tables: list[Table] = []
    if "trained" in report.policies:
        tables.append(_reasons(report.policies["trained"], "nominal"))
    if report.table_i is not None:
        tables += [_reasons(report.table_i.walks, "Table I"), _friction(report.table_i)]
    parts: list[tuple[object, Callable[..., Table]]] = [
        (report.tracking, _tracking),
        (report.quality, _quality),
        (report.reference, reference_table),
        (report.style, _style),
    ]
    return [*tables, *(make(part) for part, make in parts if part)]


def verdict_table(findings: Sequence[Finding], title: str) -> Table:
    """Every target with figure, interval, sample and what they show."""
    result = table(title, ("target",), ("", "asked for", "reached", "95 %", "n"))
    for finding in findings:
        bound = ">=" if finding.at_least else "<="
        result.add_row(
            finding.name + (f"\n({finding.note})" if finding.note else ""),
            finding.verdict,
            f"{bound} {finding.target:g}",
            cell(finding.reached, ".3f"),
            "-" if finding.low is None else f"{finding.low:.3f}-{finding.high:.3f}",
            str(finding.n),
        )
    return result


def verdict_markdown(findings: Sequence[Finding]) -> str:
    """The same in Markdown."""
    rows = []
    for finding in findings:
        bound = ">=" if finding.at_least else "<="
        interval = "-" if finding.low is None else f"{finding.low:.3f} to {finding.high:.3f}"
        note = f" ({finding.note})" if finding.note else ""
        asked, reached = f"{bound} {finding.target:g}", cell(finding.reached, ".3f")
        rows.append([finding.name + note, asked, reached, interval, str(finding.n), finding.verdict])
    return pipe_table(["target", "asked for", "reached", "95 % interval", "n", ""], rows)


def _right(part: GaitSummary) -> float | None:
    return of_estimate(part.gait_accuracy)


def _gaits(report: Report) -> Table:
    """One row per policy, for the first one also a row per skill."""
    headings = ("n", "gait right", "95 %", "falls", "Hz", "expert Hz", "v err m/s", "yaw err rad/s")
    result = table("gaits, nominal", ("policy", "skill"), (*headings, "stepping", "duty", "flight", "touches"))
    for policy, summary in report.policies.items():
        skills = worst_first(summary.skills, _right) if policy == "trained" else {}
        for skill, part in (skills | {"all": summary.all}).items():
            expert = report.expert.get(skill) if policy == "trained" else None
            result.add_row(
                policy,
                skill,
                str(part.rollouts),
                *fraction_cells(part.gait_accuracy),
                str(part.falls),
                cell(part.frequency_hz, ".2f"),
                cell(expert.frequency_hz if expert else None, ".2f"),
                cell(part.linear_error_m_s, ".3f"),
                cell(part.yaw_rate_error_rad_s, ".3f"),
                percent(part.stepping),
                cell(part.duty, ".2f"),
                cell(part.flight_fraction, ".2f"),
                cell(part.touches_per_stride, ".2f"),
                end_section=skill == "all",
            )
    return result


def _reasons(walks: PolicySummary, condition: str) -> Table:
    """Upright walks by what is wrong with them."""
    criteria = list(walks.all.failed)
    title = f"walks that are not right, {condition}, by criterion (one walk may fail several)"
    result = table(title, ("skill",), ("n", "fell", *criteria))
    for skill, part in (walks.skills | {"all": walks.all}).items():
        counts = (part.rollouts, part.falls, *part.failed.values())
        result.add_row(skill, *(str(count) if count else "-" for count in counts))
    return result


def _table_i(found: TableI) -> Table:
    headings = ("n", "gait right", "95 %", "falls", "v err m/s", "yaw err rad/s")
    result = table("the whole of Table I, sensor noise and pushes at once", ("skill",), headings)
    for skill, part in (worst_first(found.walks.skills, _right) | {"all": found.walks.all}).items():
        result.add_row(
            skill,
            str(part.rollouts),
            *fraction_cells(part.gait_accuracy),
            str(part.falls),
            cell(part.linear_error_m_s, ".3f"),
            cell(part.yaw_rate_error_rad_s, ".3f"),
        )
    return result


def _friction(found: TableI) -> Table:
    result = table("by friction, under the same", ("friction",), ("n", "gait right", "95 %", "falls"))
    for part in found.friction:
        if part.low is None:
            name = "all" if part.high is None else f"below {part.high:g}"
        else:
            name = f"from {part.low:g}" if part.high is None else f"{part.low:g} to {part.high:g}"
        result.add_row(name, str(part.right.n if part.right else 0), *fraction_cells(part.right), str(part.falls))
    return result


def _tracking(tracking: dict[str, TrackingSummary]) -> Table:
    speeds, turns = tracking["all"].by_speed, tracking["all"].by_turn
    headings = [f"v err {name}" for name in speeds] + [f"yaw err {name}" for name in turns]
    result = table("velocity errors by command, m/s and rad/s", ("skill",), headings)
    for skill, part in tracking.items():
        cells = [part.by_speed[name].linear_error_m_s if name in part.by_speed else None for name in speeds]
        cells += [part.by_turn[name].yaw_rate_error_rad_s if name in part.by_turn else None for name in turns]
        result.add_row(skill, *(cell(value, ".3f") for value in cells))
    return result


def _quality(quality: dict[str, QualitySummary]) -> Table:
    headings = ("falls/min", "peak torque", "at limit", "near stop", "action rate rad", "slip m/s", "power W", "CoT")
    result = table("quality", ("skill",), headings)
    for skill, part in quality.items():
        result.add_row(
            skill,
            cell(part.falls_per_minute, ".2f"),
            percent(part.peak_torque_share),
            cell(part.torque_at_limit_share, ".2%"),
            cell(part.joint_near_stop_share, ".2%"),
            cell(part.action_rate_rad, ".3f"),
            cell(part.foot_slip_m_s, ".3f"),
            cell(part.power_w, ".0f"),
            cell(part.cost_of_transport, ".2f"),
        )
    return result


def _style(style: dict[str, StyleSummary]) -> Table:
    headings = ("policy", "expert, same skill", "expert, other skill")
    result = table("distance to the nearest expert clip (DTW)", ("skill",), headings)
    for skill, part in style.items():
        values = (part.policy, part.expert_same_skill, part.expert_other_skill)
        result.add_row(skill, *(cell(value, ".2f") for value in values))
    return result
