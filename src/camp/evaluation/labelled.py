"""Judging the judge: motions whose right answer is known, by whom they were made, and how many are judged right.

The expert's clips show what their files say; transitions and standing show no skill. Fooling logs, sines and standing
robots show nothing that they are passed off as.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from rich.table import Table

from camp.common.paths import shipped_motions
from camp.evaluation.cells import table
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.controllers import OpenLoopSine, Standing
from camp.evaluation.fooling import PERIOD_S, fooling_logs, log_of
from camp.evaluation.plan import Plan, Planner
from camp.evaluation.recording import record
from camp.evaluation.rollout import Setting, roll_out
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import NO_SKILL, Skill, skill_set
from camp.metrics.criteria import ContactLog, failures, is_right, read_walks
from camp.motion.clips.clip import SPLITS, STAND, Clip
from camp.motion.clips.consistency import foot_height
from camp.motion.clips.sampler import ReferenceStates
from camp.motion.clips.store import load_clips
from camp.robots.registry import DEFAULT_ROBOT, find_robot
from camp.robots.robot import Robot

SKILLS = skill_set(tuple(GAIT_PHASES), "gait_frequency", (2.0, 3.0, 4.0))
AMPLITUDES_RAD = (0.1, 0.125, 0.15)
ROLLOUT_SKILLS = skill_set(tuple(GAIT_PHASES), "gait_frequency", (2.0, 3.0))


@dataclass(frozen=True)
class Answer:
    """One motion. shows: the skill's name, or "none"; adversarial: made to be taken for a skill."""

    kind: str
    name: str
    shows: str
    judged: str
    adversarial: bool

    @property
    def correct(self) -> bool:
        """Whether the judge says what is."""
        return self.judged == self.shows


def shown(log: ContactLog, skills: tuple[Skill, ...] = SKILLS) -> str:
    """The skill that one walk shows by all criteria, or "none"."""
    reading = read_walks(log)
    names = [s.name for s in skills if is_right(failures(reading, s.gait, s.frequency_hz))[0]]
    return names[0] if names else NO_SKILL


def labelled_answers() -> Iterator[Answer]:
    """Every motion of the set, judged. Raises ClipError where the shipped clips are missing."""
    robot = find_robot(DEFAULT_ROBOT)
    for clip, name in expert_clips(robot):
        log = ContactLog(clip.foot_contact[None], clip.dt, foot_height(robot, clip)[None], clip.dt)
        truth = NO_SKILL if clip.split in (STAND, "transition") else Skill(clip.gait, clip.frequency_hz).name
        yield Answer(f"expert, {clip.split}", name, truth, shown(log), False)
    for name, (contact, gait, frequency) in fooling_logs().items():
        failed = failures(read_walks(log_of(contact, period_s=PERIOD_S)), gait, frequency)
        judged = Skill(gait, frequency).name if is_right(failed)[0] else NO_SKILL
        yield Answer("fooling log", name, NO_SKILL, judged, True)
    yield from _rollouts(robot)


def expert_clips(robot: Robot) -> Iterator[tuple[Clip, str]]:
    """All shipped clips of a robot, standing included, with a name."""
    folder = shipped_motions(robot.name)
    for clip in load_clips(robot, folder, (*GAIT_PHASES, STAND), [split for split in SPLITS if split != "perturbed"]):
        yield clip, f"{clip.gait} {clip.frequency_hz:g} Hz {np.round(clip.command[-1:], 2).tolist()}"


def _rollouts(robot: Robot) -> Iterator[Answer]:
    """Open-loop sines and standing, from standing and from the midst of a stride, in simulation."""
    clips = [clip for clip, _ in expert_clips(robot) if clip.split == "steady"]
    references = ReferenceStates([c for c in clips if c.frequency_hz in (2.0, 3.0)], ROLLOUT_SKILLS)
    evaluation = compose_evaluation()
    planner = Planner(evaluation, robot, ROLLOUT_SKILLS, PERIOD_S, None, references)
    jobs: list[tuple[Plan, Standing | OpenLoopSine]] = [(planner.walks(2, "labelled"), Standing(robot))]
    jobs += [(planner.walks(2, "labelled"), OpenLoopSine(robot, ROLLOUT_SKILLS, size)) for size in AMPLITUDES_RAD]
    names = ["standing", *(f"sine of {size:g} rad" for size in AMPLITUDES_RAD)]
    setting = Setting(PERIOD_S, robot, evaluation.noise, evaluation.push_period_s, evaluation.seed)
    for name, trace in zip(names, roll_out(jobs, setting), strict=True):
        recording = record(trace)
        log = recording.log(round(evaluation.discard_s / PERIOD_S))
        for row, label in enumerate(recording.skill[:, 0]):
            wanted, one = ROLLOUT_SKILLS[label], log.take(np.array([row]))
            right = is_right(failures(read_walks(one), wanted.gait, wanted.frequency_hz))[0]
            judged = wanted.name if right and not recording.fallen[row] else NO_SKILL
            yield Answer("roll-out", f"{name} as {wanted.name}", NO_SKILL, judged, True)


def answers_table(answers: list[Answer]) -> Table:
    """Accuracy by kind, and every wrong answer."""
    correct = sum(answer.correct for answer in answers)
    false = sum(answer.adversarial and not answer.correct for answer in answers)
    adversarial = sum(answer.adversarial for answer in answers)
    title = (
        f"the judge's own accuracy: {correct} of {len(answers)} ({100 * correct / len(answers):.1f} %); "
        f"{false} of {adversarial} adversarial motions judged right"
    )
    result = table(title, ("made by",), ("motions", "judged as they are", "wrong"))
    for kind in dict.fromkeys(answer.kind for answer in answers):
        group = [answer for answer in answers if answer.kind == kind]
        wrong = [f"{answer.name}: {answer.judged}" for answer in group if not answer.correct]
        result.add_row(kind, str(len(group)), str(len(group) - len(wrong)), "; ".join(wrong) or "-")
    return result
