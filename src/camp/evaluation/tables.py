"""The report as printed: one table per part, units in the headings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.console import Group
from rich.table import Table

Report = dict[str, Any]


def printed(report: Report) -> Group:
    """All tables for the parts that the report has."""
    tables = []
    if "policies" in report:
        tables.append(_gaits(report))
    for key, make in (("tracking", _tracking), ("quality", _quality), ("style", _style)):
        if key in report:
            tables.append(make(report[key]))
    if "switching" in report:
        tables.append(_switching(report["switching"]))
    if "robustness" in report:
        tables.append(_robustness(report["robustness"]))
    return Group(*tables, _verdict(report["verdict"]))


def _gaits(report: Report) -> Table:
    """One row per policy, for the first one also a row per skill."""
    headings = ("gait right", "stepping", "falls", "Hz", "expert Hz", "duty", "flight", "v err m/s", "yaw err rad/s")
    table = _table("gaits", ("policy", "skill"), (*headings, "thigh", "calf"))
    expert = report.get("expert", {})
    for policy, summary in report["policies"].items():
        skills = summary["skills"] if policy == "trained" else {}
        for skill, part in (skills | {"all": summary["all"]}).items():
            joint = part["joint_tracking"]
            table.add_row(
                policy,
                skill,
                _percent(part["gait_accuracy"]),
                _percent(part["stepping"]),
                f"{part['falls']}/{part['rollouts']}",
                _cell(part["frequency_hz"], ".2f"),
                _cell(expert.get(skill, {}).get("frequency_hz") if policy == "trained" else None, ".2f"),
                _cell(part["duty"], ".2f"),
                _cell(part["flight_fraction"], ".2f"),
                _cell(part["linear_error_m_s"], ".3f"),
                _cell(part["yaw_rate_error_rad_s"], ".3f"),
                _cell(joint.get("thigh"), ".1%"),
                _cell(joint.get("calf"), ".1%"),
                end_section=skill == "all",
            )
    return table


def _tracking(tracking: Report) -> Table:
    speeds, turns = tracking["all"]["by_speed"], tracking["all"]["by_turn"]
    headings = [f"v err {name}" for name in speeds] + [f"yaw err {name}" for name in turns]
    table = _table("velocity errors by command, m/s and rad/s", ("skill",), headings)
    for skill, part in tracking.items():
        cells = [part["by_speed"][name]["linear_error_m_s"] for name in speeds]
        cells += [part["by_turn"][name]["yaw_rate_error_rad_s"] for name in turns]
        table.add_row(skill, *(_cell(cell, ".3f") for cell in cells))
    return table


def _quality(quality: Report) -> Table:
    headings = ("falls/min", "peak torque", "at limit", "near stop", "action rate rad", "slip m/s", "power W", "CoT")
    table = _table("quality", ("skill",), headings)
    for skill, part in quality.items():
        table.add_row(
            skill,
            _cell(part["falls_per_minute"], ".2f"),
            _percent(part["peak_torque_share"]),
            _cell(part["torque_at_limit_share"], ".2%"),
            _cell(part["joint_near_stop_share"], ".2%"),
            _cell(part["action_rate_rad"], ".3f"),
            _cell(part["foot_slip_m_s"], ".3f"),
            _cell(part["power_w"], ".0f"),
            _cell(part["cost_of_transport"], ".2f"),
        )
    return table


def _style(style: Report) -> Table:
    headings = ("policy", "expert, same skill", "expert, other skill")
    table = _table("distance to the nearest expert clip (DTW)", ("skill",), headings)
    for skill, part in style.items():
        keys = ("policy", "expert_same_skill", "expert_other_skill")
        table.add_row(skill, *(_cell(part[key], ".2f") for key in keys))
    return table


def _switching(switching: Report) -> Table:
    headings = ("switches", f"within {switching['within_s']:g} s", "median s", "90 % s")
    peaks = ("peak torque", "steady", "jump rad/s", "steady")
    title = f"switching: {switching['sequences']} sequences, {switching['falls']} falls"
    table = _table(title, ("to",), headings + peaks)
    for name, part in (switching["to_gait"] | {"all": switching}).items():
        at_switch, steady = part["at_switch"], part["steady"]
        table.add_row(
            name,
            str(part["switches"]),
            _percent(part["established"]),
            _cell(part["seconds_median"], ".2f"),
            _cell(part["seconds_90_percent"], ".2f"),
            _percent(at_switch["peak_torque_share"]),
            _percent(steady["peak_torque_share"]),
            _cell(at_switch["velocity_jump_rad_s"], ".1f"),
            _cell(steady["velocity_jump_rad_s"], ".1f"),
        )
    return table


def _robustness(robustness: Report) -> Table:
    table = _table("robustness", ("condition",), ("gait right", "weakest skill", "falls", "v err m/s", "yaw err rad/s"))
    for name, part in robustness.items():
        weakest = min(part["skills"], key=part["skills"].__getitem__)
        table.add_row(
            name,
            _percent(part["gait_accuracy"]),
            f"{weakest} {_percent(part['skills'][weakest])}",
            f"{part['falls']}/{part['rollouts']}",
            _cell(part["linear_error_m_s"], ".3f"),
            _cell(part["yaw_rate_error_rad_s"], ".3f"),
        )
    return table


def _verdict(findings: Sequence[Report]) -> Table:
    table = _table("verdict", ("target",), ("asked for", "reached", "", "of"))
    for finding in findings:
        bound = "at least" if finding["at_least"] else "at most"
        table.add_row(
            finding["name"],
            f"{bound} {finding['target']:g}",
            _cell(finding["reached"], ".3f"),
            "met" if finding["met"] else "missed",
            finding["note"],
        )
    return table


def _table(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    table = Table(title=title, title_justify="left")
    for heading in left:
        table.add_column(heading)
    for heading in right:
        table.add_column(heading, justify="right")
    return table


def _percent(value: float | None) -> str:
    """Whole percent, rounded down: 100 % is what has no exception."""
    return "-" if value is None else f"{math.floor(100.0 * value + 1e-9)}%"


def _cell(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
