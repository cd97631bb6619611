"""Tables of the parts about motion beside the expert's, switches and disturbances."""

from __future__ import annotations

from rich.table import Table

from camp.evaluation.cells import cell, fraction_cells, of_estimate, percent, table, worst_first
from camp.evaluation.report import ConditionSummary, JointReference, ReferenceSummary, SwitchGroup, SwitchingSummary

_KINDS = ("thigh", "calf")


def reference_table(reference: dict[str, ReferenceSummary]) -> Table:
    """accuracy / skill score of thigh and calf, beside a constant pose and another gait's clips."""
    headings = ("n", "thigh", "calf", "standing", "standing", "other gait", "other gait")
    title = "tracking of the expert's mean stride: accuracy, skill score (the paper gives no formula; this is ours)"
    result = table(title, ("skill",), headings)
    for skill, part in reference.items():
        cells = [_joint(group.get(k)) for group in (part.policy, part.standing, part.other_gait) for k in _KINDS]
        result.add_row(skill, str(part.walks), *cells)
    return result


def switching_table(switching: SwitchingSummary) -> Table:
    """Times to the new skill, and peaks at the switch beside steady ones."""
    headings = ("switches", f"within {switching.within_s:g} s", "95 %", "median s", "90 % s")
    peaks = ("peak torque", "steady", "jump rad/s", "steady")
    title = f"switching: {switching.sequences} sequences, {switching.falls} falls"
    result = table(title, ("switch",), headings + peaks)
    rows = {f"changes {name}": part for name, part in switching.by_change.items()}
    rows |= {f"to {name}": part for name, part in switching.to_skill.items()}
    rows = worst_first(rows, lambda part: of_estimate(part.completed))
    for name, part in (rows | {"all": switching.all}).items():
        result.add_row(name, str(part.switches), *_switch(part))
    return result


def robustness_table(robustness: dict[str, ConditionSummary], most: int | None = None) -> Table:
    """One row per disturbance, the worst first, at most so many."""
    headings = ("n", "gait right", "95 %", "weakest skill", "falls", "v err m/s", "yaw err rad/s")
    shown = worst_first(robustness, lambda part: of_estimate(part.gait_accuracy), most)
    some = f", the worst {len(shown)} of {len(robustness)}" if len(shown) < len(robustness) else ""
    result = table(f"one disturbance at a time{some}", ("condition",), headings)
    for name, part in shown.items():
        weakest = min(part.skills, key=part.skills.__getitem__)
        result.add_row(
            name,
            str(part.rollouts),
            *fraction_cells(part.gait_accuracy),
            f"{weakest} {percent(part.skills[weakest])}",
            str(part.falls),
            cell(part.linear_error_m_s, ".3f"),
            cell(part.yaw_rate_error_rad_s, ".3f"),
        )
    return result


def _joint(found: JointReference | None) -> str:
    return "-" if found is None else f"{found.accuracy:.2f}, {found.skill:.2f}"


def _switch(part: SwitchGroup) -> list[str]:
    return [
        *fraction_cells(part.completed),
        cell(part.seconds_median, ".2f"),
        cell(part.seconds_90_percent, ".2f"),
        percent(part.at_switch.peak_torque_share),
        percent(part.steady.peak_torque_share),
        cell(part.at_switch.velocity_jump_rad_s, ".1f"),
        cell(part.steady.velocity_jump_rad_s, ".1f"),
    ]
