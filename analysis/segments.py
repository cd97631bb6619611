"""Motion that a run's discriminators have not learned from: new segments of the expert, and the policy's own walks.

The expert walks a command that none of the shipped clips has, 10 s of each skill as in the paper (Sec. IV-A). Its
segments are kept in outputs/reference_segments; making one takes seconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from analysis.load import features_of
from camp.build import Run
from camp.common.errors import ClipError
from camp.data import Transition
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.output import expert_motions
from camp.evaluation.plan import Planner
from camp.evaluation.recording import record
from camp.evaluation.rollout import Setting, roll_out
from camp.evaluation.subjects import subject_of_run
from camp.gaits.skills import Skill
from camp.motion.clips.clip import Clip
from camp.motion.clips.sampler import ReferenceStates, transitions
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.dataset.generate import generate_clip
from camp.motion.dataset.requests import ClipRequest
from camp.robots.registry import find_robot

UNSEEN = (0.45, 0.1, 0.2)  # vx, vy in m/s, yaw rate in rad/s
SEGMENT_S = 10.0
FOLDER = Path("outputs/reference_segments")
WALKS_PER_SKILL = 2
PARTS = ("suite=short", "parts=[gait]", f"walks.per_skill={WALKS_PER_SKILL}", "video=false")


def reference_segments(run: Run, folder: Path = FOLDER) -> list[Clip]:
    """10 s of each of the run's skills; made where they are not there yet. Raises ClipError."""
    cells = dict.fromkeys(
        (skill.gait, hz) for skill in run.config.motion.skill_set() for hz in _frequencies(skill, run)
    )
    jobs = [(run.config.robot.name, ClipRequest(gait, hz, UNSEEN), folder) for gait, hz in cells]
    missing = [job for job in jobs if not _path(*job[1:]).is_file()]
    if missing:
        print(f"the expert walks {len(missing)} new segments of {SEGMENT_S:g} s (once)", flush=True)
        with get_context("spawn").Pool(min(2, len(missing))) as pool:
            pool.map(_make, missing)
    return [load_clip(_path(request, folder)) for _, request, folder in jobs]


def _frequencies(skill: Skill, run: Run) -> Sequence[float]:
    return [skill.frequency_hz] if skill.frequency_hz else list(run.config.motion.frequencies_hz)


def _path(request: ClipRequest, folder: Path) -> Path:
    return folder / f"{request.name}_{SEGMENT_S:g}s.npz"


def _make(job: tuple[str, ClipRequest, Path]) -> None:
    name, request, folder = job
    torch.set_num_threads(1)
    clip = generate_clip(find_robot(name), request, round(SEGMENT_S / 0.02) + 1)
    save_clip(_path(request, folder), clip)


def policy_features(run: Run, folder: Path) -> tuple[NDArray[np.floating], NDArray[np.str_]]:
    """Features (P, Z) of the policy's walks at random commands, and the skills (P,) that were commanded."""
    if run.skill_prior is None:
        raise ClipError(f"run {folder}: has no skill discriminator; choose a run trained with one")
    evaluation = compose_evaluation(PARTS)
    subject = subject_of_run(run, folder, "walks", baselines=False)
    contract, skills = subject.contract, subject.contract.skill_set
    clips = [clip for clip in expert_motions() if any(s.includes(clip.gait, clip.frequency_hz) for s in skills)]
    planner = Planner(
        evaluation, skills, contract.control_period_s, contract.command_range, ReferenceStates(clips, skills)
    )
    plan = planner.walks(WALKS_PER_SKILL, "analysis")
    robot = find_robot(run.config.robot.name)
    setting = Setting(contract.control_period_s, robot, evaluation.noise, evaluation.push_period_s, evaluation.seed)
    (trace,) = roll_out([(plan, subject.controller())], setting)
    walked = record(trace)
    features, names = [], []
    for row in range(len(walked)):
        states = walked.amp_state[row, round(evaluation.discard_s / walked.period_s) : walked.steps_upright[row]]
        if len(states) > run.config.env.transition_ages[0]:
            shown = transitions(torch.from_numpy(states), run.config.env.transition_ages)
            found = run.skill_prior.predict(Transition(shown, torch.zeros(len(shown), dtype=torch.int64)))
            features.append(found.numpy())
            names += [skills[walked.skill[row, 0]].name] * len(shown)
    return np.concatenate(features), np.array(names)


def segment_features(run: Run, folder: Path = FOLDER):
    """The skill discriminator's features of the reference segments, as `analysis.load` gives those of clips."""
    return features_of(run, reference_segments(run, folder))
