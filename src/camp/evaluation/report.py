"""From a recording to numbers: gait accuracy, velocity errors, joint tracking, falls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.table import Table

from camp.evaluation.rollout import Recording
from camp.metrics.gait import label_over_time, measure_gait, switch_time
from camp.metrics.tracking import (
    FAST_COMMAND_M_S,
    by_joint_kind,
    joint_tracking_accuracy,
    joint_tracking_of_range,
    mean_velocity,
    velocity_error,
)
from camp.motion.skills import NO_SKILL, Skill, names, performed


def summarize(recording: Recording, skills: Sequence[Skill], discard_s: float) -> dict[str, Any]:
    """Numbers of one policy over the grid, per skill and over all; plain values, ready for JSON.

    Velocity errors compare the mean velocity after ``discard_s`` with the command, in m/s and rad/s; a robot that
    fell counts with velocity 0 from there on, and as no gait.
    """
    first = round(discard_s / recording.period_s)
    grid = slice(0, -1)
    contact, velocity = recording.contact[grid, first:], recording.velocity[grid, first:]
    skill, command = recording.skill[grid, 0], recording.command[grid, 0]
    fallen = recording.fallen[grid]
    gait = measure_gait(contact, recording.period_s)
    label = np.where(fallen, "fell", performed(gait.label, gait.frequency_hz, skills))
    error = velocity_error(command, mean_velocity(velocity, recording.period_s))
    joints = recording.joint_target[grid, first:], recording.joint_position[grid, first:]
    tracking, of_range = joint_tracking_accuracy(*joints), joint_tracking_of_range(*joints)
    known = names(skills)
    fast = np.hypot(command[:, 0], command[:, 1]) >= FAST_COMMAND_M_S

    def part(chosen: np.ndarray, name: str | None) -> dict[str, Any]:
        """Numbers of the roll-outs ``chosen``, which were all to show ``name``."""
        upright = chosen & ~fallen
        wanted = np.array(known)[skill] if name is None else name
        return {
            "rollouts": int(chosen.sum()),
            "falls": int(fallen[chosen].sum()),
            "gait_accuracy": float((label == wanted)[chosen].mean()),
            "stepping": float((gait.stepping.all(axis=1) & ~fallen)[chosen].mean()),
            "frequency_hz": _mean(gait.frequency_hz[upright]),
            "phase": [_circular_mean(gait.phase[upright, leg]) for leg in range(4)],
            "duty": _mean(gait.duty[upright]),
            "flight_fraction": _mean(gait.flight_fraction[upright]),
            "linear_error_m_s": float(error.linear[chosen].mean()),
            "linear_error_fast_m_s": _mean(error.linear[chosen & fast]),
            "yaw_rate_error_rad_s": float(error.angular[chosen].mean()),
            "joint_tracking": _by_kind(tracking[upright]),
            "joint_tracking_of_range": _by_kind(of_range[upright]),
        }

    shown = [*known, NO_SKILL, "fell"]
    return {
        "all": part(np.ones(len(skill), dtype=bool), None),
        "skills": {name: part(skill == k, name) for k, name in enumerate(known)},
        "confusion": {
            name: {other: int(((label == other) & (skill == k)).sum()) for other in shown}
            for k, name in enumerate(known)
        },
    }


def summarize_switching(recording: Recording, skills: Sequence[Skill]) -> dict[str, Any]:
    """The switching sequence: seconds until each commanded gait was held for a full second, None if never.

    A second is too short to tell stride frequencies apart, so that the gait alone counts.
    """
    contact, skill = recording.contact[-1], recording.skill[-1]
    label = label_over_time(contact, recording.period_s)
    begins = np.flatnonzero(np.diff(skill, prepend=skill[0] - 1))
    ends = [*begins[1:], len(skill)]
    seconds = {}
    for begin, end in zip(begins, ends, strict=True):
        wanted = skills[skill[begin]]
        taken = switch_time(label[:end], wanted.gait, int(begin), recording.period_s)
        seconds[wanted.name] = None if np.isnan(taken) else taken
    return {"fell": bool(recording.fallen[-1]), "seconds_to_gait": seconds}


def arrays(recording: Recording, skills: Sequence[Skill], commands: list[list[float]]) -> dict[str, np.ndarray]:
    """What eval.npz holds: the grid by skill and command (K, G, ...), and the switching sequence."""
    grid = (len(skills), len(commands))
    gait = measure_gait(recording.contact[:-1], recording.period_s)
    return {
        "period": np.array(recording.period_s),
        "skills": np.array(names(skills)),
        "commands": np.array(commands, dtype=np.float32),
        "contact": recording.contact[:-1].reshape(*grid, -1, 4),
        "steps_upright": recording.steps_upright[:-1].reshape(grid),
        "phase": gait.phase.reshape(*grid, 4),
        "frequency_hz": gait.frequency_hz.reshape(grid),
        "switch_steps_upright": recording.steps_upright[-1],
        "skill_switch_contact": recording.contact[-1],
        "skill_switch_skill": recording.skill[-1],
        "skill_switch_joint_position": recording.joint_position[-1],
        "skill_switch_joint_target": recording.joint_target[-1],
        "skill_switch_velocity": recording.velocity[-1],
        "skill_switch_command": recording.command[-1],
    }


def table(policies: dict[str, dict[str, Any]]) -> Table:
    """One row per policy, for the first one also a row per skill."""
    result = Table(title="evaluation")
    headings = (
        "policy",
        "skill",
        "gait right",
        "stepping",
        "falls",
        "Hz",
        "v err m/s",
        "v err fast",
        "yaw err rad/s",
        "thigh",
        "calf",
    )
    for column, heading in enumerate(headings):
        result.add_column(heading, justify="left" if column < 2 else "right")
    for number, (policy, summary) in enumerate(policies.items()):
        skills = summary["skills"] if number == 0 else {}
        for skill, part in (skills | {"all": summary["all"]}).items():
            joint = part["joint_tracking"]
            result.add_row(
                policy,
                skill,
                f"{part['gait_accuracy']:.0%}",
                f"{part['stepping']:.0%}",
                f"{part['falls']}/{part['rollouts']}",
                _cell(part["frequency_hz"], ".2f"),
                _cell(part["linear_error_m_s"], ".3f"),
                _cell(part["linear_error_fast_m_s"], ".3f"),
                _cell(part["yaw_rate_error_rad_s"], ".3f"),
                _cell(joint.get("thigh"), ".1%"),
                _cell(joint.get("calf"), ".1%"),
                end_section=skill == "all",
            )
    return result


def _by_kind(accuracy: np.ndarray) -> dict[str, float]:
    """Mean over roll-outs and legs of (R, 12), per kind of joint; empty where there are no roll-outs."""
    return {k: float(v) for k, v in by_joint_kind(accuracy.mean(axis=0)).items()} if len(accuracy) else {}


def _circular_mean(phase: np.ndarray) -> float | None:
    """Mean of phases in strides, in [0, 1); None where no finite one is given."""
    finite = phase[np.isfinite(phase)]
    angle = np.angle(np.exp(2j * np.pi * finite).sum()) if finite.size else np.nan
    return float(angle / (2 * np.pi) % 1.0) if finite.size else None


def _mean(values: np.ndarray) -> float | None:
    """Mean of the finite values; None where there are none."""
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if finite.size else None


def _cell(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
