"""Part "gait": does each skill look as it should, judged by measured foot contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from camp.evaluation.reading import FELL, GridReading
from camp.evaluation.values import by_kind, circular_mean, mean
from camp.gaits.schedule import nominal_duty, nominal_flight
from camp.gaits.skills import NO_SKILL, Skill
from camp.metrics.tracking import FAST_COMMAND_M_S, joint_tracking_accuracy, joint_tracking_of_range
from camp.motion.clips.clip import Clip
from camp.motion.dataset.requests import describe_command


def summarize(reading: GridReading) -> dict[str, Any]:
    """Numbers of one policy over the grid, per skill and over all; plain values, ready for JSON.

    Velocity errors are those of the mean velocity, in m/s and rad/s. Joints are averaged over the roll-outs that
    stayed upright, the rhythm over those of them that step with all feet.
    """
    skills = {name: _averages(reading, chosen) for name, chosen in reading.groups()}
    shown = [*reading.skills, NO_SKILL, FELL]
    confusion = {
        name: {other: int((chosen & (reading.shown == other)).sum()) for other in shown}
        for name, chosen in reading.groups()
        if name != "all"
    }
    return {"all": skills.pop("all"), "skills": skills, "confusion": confusion}


def beside_expert(reading: GridReading, skills: Sequence[Skill], clips: Sequence[Clip]) -> dict[str, Any]:
    """Per skill the expert's stride frequency, duty and flight, and how far the policy's frequency is from it.

    The expert's frequency is, for each roll-out, the skill's own or, where skills have none, that of the clips of its
    gait nearest to the measured one; duty and flight go with it. Averaged over the roll-outs whose rhythm counts.
    """
    result = {}
    for label, skill in enumerate(skills):
        known = np.unique([clip.frequency_hz for clip in clips if skill.includes(clip.gait, clip.frequency_hz)])
        measured = reading.gait.frequency_hz[(reading.wanted == label) & reading.stepping]
        nearest = known[np.abs(measured[:, None] - known).argmin(axis=1)]
        result[skill.name] = {
            "frequency_hz": mean(nearest),
            "frequency_error": mean(np.abs(measured / nearest - 1.0)),
            "duty": mean(np.array([nominal_duty(skill.gait, hz) for hz in nearest])),
            "flight_fraction": mean(np.array([nominal_flight(skill.gait, hz) for hz in nearest])),
        }
    return result


def performed_by_command(reading: GridReading, commands: Sequence[Sequence[float]]) -> dict[str, dict[str, str]]:
    """What was shown in each cell of the grid: skill -> command -> skill performed."""
    words = [describe_command((vx, vy, wz)) for vx, vy, wz in commands]
    shown = reading.shown.reshape(len(reading.skills), len(commands))
    return {name: dict(zip(words, shown[k].tolist(), strict=True)) for k, name in enumerate(reading.skills)}


def _averages(reading: GridReading, chosen: np.ndarray) -> dict[str, Any]:
    gait, error = reading.gait, reading.error
    upright, stepping = chosen & ~reading.fallen, chosen & reading.stepping
    fast = np.hypot(reading.command[:, 0], reading.command[:, 1]) >= FAST_COMMAND_M_S
    joints = reading.recording.joint_target[upright], reading.recording.joint_position[upright]
    return {
        "rollouts": int(chosen.sum()),
        "falls": int(reading.fallen[chosen].sum()),
        "gait_accuracy": float(reading.right[chosen].mean()),
        "stepping": float(reading.stepping[chosen].mean()),
        "frequency_hz": mean(gait.frequency_hz[stepping]),
        "phase": [circular_mean(gait.phase[stepping, leg]) for leg in range(4)],
        "duty": mean(gait.duty[stepping]),
        "flight_fraction": mean(gait.flight_fraction[stepping]),
        "linear_error_m_s": float(error.linear[chosen].mean()),
        "linear_error_fast_m_s": mean(error.linear[chosen & fast]),
        "yaw_rate_error_rad_s": float(error.angular[chosen].mean()),
        "joint_tracking": by_kind(joint_tracking_accuracy(*joints)),
        "joint_tracking_of_range": by_kind(joint_tracking_of_range(*joints)),
    }
