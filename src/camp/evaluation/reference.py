"""Part "reference": are the joints where the expert's are, in the stride of the same skill and command?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from camp.evaluation.reading import Reading
from camp.evaluation.report import JointReference, ReferenceSummary
from camp.gaits.skills import Skill
from camp.metrics.reference import ReferenceTracking, mean_stride, reference_tracking
from camp.metrics.tracking import by_joint_kind
from camp.motion.clips.clip import Clip
from camp.robots.quadruped import NUM_JOINTS
from camp.robots.robot import Robot

COMPARED = ("thigh", "calf")  # as in the paper; a hip moves by a few degrees, of which any error is a large fraction
Strides = Mapping[tuple[str, float, tuple[float, ...]], np.ndarray]  # gait, Hz, command -> mean stride


def summarize_reference(robot: Robot, reading: Reading, clips: Sequence[Clip]) -> dict[str, ReferenceSummary]:
    """Tracking of the expert's mean stride, per skill and over all, from the upright walks with a rhythm and a clip."""
    strides, pose = _strides(clips), np.array(robot.default_joint_position)
    found: dict[str, list[list[ReferenceTracking]]] = {}
    for label, skill in enumerate(reading.skills):
        rows = np.flatnonzero((reading.wanted == label) & reading.stepping & np.isfinite(reading.gait.frequency_hz))
        walks = [_compare(reading, int(row), skill, strides, pose) for row in rows]
        found[skill.name] = [walk for walk in walks if walk is not None]
    found["all"] = [each for walks in found.values() for each in walks]
    return {
        name: ReferenceSummary(
            walks=len(walks),
            policy=_mean(walk[0] for walk in walks),
            standing=_mean(walk[1] for walk in walks),
            other_gait=_mean(walk[2] for walk in walks if len(walk) > 2),
        )
        for name, walks in found.items()
    }


def _strides(clips: Sequence[Clip]) -> Strides:
    return {
        (clip.gait, clip.frequency_hz, _key(clip.command)): mean_stride(clip.joint_position, clip.frequency_hz, clip.dt)
        for clip in clips
        if clip.is_steady
    }


def _key(command: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(value), 3) + 0.0 for value in command)


def _compare(
    reading: Reading, row: int, skill: Skill, strides: Strides, pose: np.ndarray
) -> list[ReferenceTracking] | None:
    """The walk, the default pose, and the walk against another gait; None where the expert has no such clip."""
    measured, command = float(reading.gait.frequency_hz[row]), _key(reading.command[row])
    own = _nearest(strides, {skill.gait}, skill.frequency_hz or measured, command)
    if own is None:
        return None
    recording = reading.recording
    position = recording.joint_position[row, reading.first_step :]
    compared = [position, np.broadcast_to(pose, (len(position), NUM_JOINTS))]
    result = [reference_tracking(each, own, measured, recording.period_s) for each in compared]
    others = {gait for gait, _, _ in strides} - {skill.gait}
    other = _nearest(strides, others, skill.frequency_hz or measured, command)
    if other is not None:
        result.append(reference_tracking(position, other, measured, recording.period_s))
    return result


def _nearest(strides: Strides, gaits: set[str], hz: float, command: tuple[float, ...]) -> np.ndarray | None:
    """The stride of the nearest frequency at exactly this command."""
    known = [key for key in strides if key[0] in gaits and key[2] == command]
    return strides[min(known, key=lambda key: abs(key[1] - hz))] if known else None


def _mean(walks: Iterable[ReferenceTracking]) -> dict[str, JointReference]:
    chosen = list(walks)
    if not chosen:
        return {}
    accuracy, skill = (
        by_joint_kind(np.mean([getattr(w, name) for w in chosen], axis=0)) for name in ("accuracy", "skill")
    )
    return {kind: JointReference(float(accuracy[kind]), float(skill[kind])) for kind in COMPARED}
