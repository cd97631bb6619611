"""The expert's own clips, judged as if they were a policy's walks: what the demonstrations are worth."""

from __future__ import annotations

import numpy as np

from camp.evaluation import gait
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.labelled import SKILLS, expert_clips
from camp.evaluation.reading import read
from camp.evaluation.recording import Recording
from camp.evaluation.reference import summarize_reference
from camp.evaluation.report import FORMAT, Report
from camp.evaluation.suite import stamp
from camp.evaluation.tracking import summarize_tracking
from camp.motion.clips.clip import Clip, amp_state
from camp.motion.clips.consistency import foot_height
from camp.robots.robot import Robot

NAME = "expert"
SUITE = "clips"  # steady ones, 4 s each at 50 Hz: neither random commands nor random starts


def judge_expert(robot: Robot) -> Report:
    """All steady clips of a robot, all gaits and frequencies. Raises ClipError where they are missing."""
    clips = [clip for clip, _ in expert_clips(robot) if clip.is_steady]
    reading = read(recording_of(robot, clips), SKILLS, 0.0)
    evaluation = compose_evaluation()
    suite = stamp(evaluation, robot)
    suite.name, suite.digest = SUITE, "-"
    return Report(
        format=FORMAT,
        suite=suite,
        run=NAME,
        variant=None,
        iteration=None,
        seed=None,
        policy=None,
        skills=[skill.name for skill in SKILLS],
        parts=["gait", "tracking", "reference"],
        duration_s=len(clips[0]) * clips[0].dt,
        discard_s=0.0,
        commands_clipped=False,
        policies={"trained": gait.summarize(reading)},
        expert=gait.beside_expert(reading, clips),
        performed={},
        table_i=None,
        tracking=summarize_tracking(reading),
        quality={},
        reference=summarize_reference(robot, reading, clips),
        style={},
        switching=None,
        robustness={},
        verdict=[],
    )


def recording_of(robot: Robot, clips: list[Clip]) -> Recording:
    """Clips of one length and held commands as roll-outs; torques are the clips' own means over a control step."""
    steps = min(len(clip) for clip in clips)
    label = [next(k for k, s in enumerate(SKILLS) if s.includes(clip.gait, clip.frequency_hz)) for clip in clips]

    def rows(name: str) -> np.ndarray:
        return np.stack([np.asarray(getattr(clip, name))[:steps] for clip in clips])

    linear, angular, velocity = rows("base_linear_velocity"), rows("base_angular_velocity"), rows("joint_velocity")
    torque = rows("joint_torque")
    return Recording(
        period_s=clips[0].dt,
        skill=np.repeat(np.array(label)[:, None], steps, axis=1),
        command=np.stack([clip.command for clip in clips]),
        velocity=np.concatenate([linear[..., :2], angular[..., 2:]], axis=-1),
        contact=rows("foot_contact"),
        foot_height=np.stack([foot_height(robot, clip)[:steps] for clip in clips]),
        joint_target=rows("joint_target_applied"),
        joint_position=rows("joint_position"),
        joint_velocity=velocity,
        torque=np.repeat(torque[:, :, None], 2, axis=2),
        power=np.abs(torque * velocity).sum(axis=-1),
        foot_speed=np.zeros((len(clips), steps, 4)),
        amp_state=np.stack([amp_state(clip)[:steps] for clip in clips]),
        qpos=np.concatenate([rows("base_position"), rows("base_quaternion"), rows("joint_position")], axis=-1),
        steps_upright=np.full(len(clips), steps),
    )
