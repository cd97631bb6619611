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

from analysis.load import ClipFeatures, features_of, first_touchdown
from analysis.nominal_walks import walk
from camp.build import Run, seen_by_discriminators
from camp.data import Transition
from camp.gaits.skills import Skill
from camp.metrics.gait import measure_gait
from camp.motion.clips.clip import Clip
from camp.motion.clips.sampler import transitions
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.dataset.generate import generate_clip
from camp.motion.dataset.requests import ClipRequest
from camp.robots.registry import find_robot

UNSEEN = (0.45, 0.1, 0.2)  # vx, vy in m/s, yaw rate in rad/s
SEGMENT_S = 10.0
FOLDER = Path("outputs/reference_segments")
FORWARD = (0.6, 0.0, 0.0)
COMMANDS = (FORWARD, UNSEEN)  # of the policy's walks
WALK_S = (2.0, 4.0)  # of a walk: until its gait has settled, and then
CONTROL_S = 0.02  # of the expert's segments
USUAL_HZ = 2.0  # of skills that have no frequency, where none is measured


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
    clips = [load_clip(_path(request, folder)) for _, request, folder in jobs]
    return seen_by_discriminators(run.config, clips)


def _frequencies(skill: Skill, run: Run) -> Sequence[float]:
    return [skill.frequency_hz] if skill.frequency_hz else list(run.config.motion.frequencies_hz)


def _path(request: ClipRequest, folder: Path) -> Path:
    return folder / f"{request.name}_{SEGMENT_S:g}s.npz"


def _make(job: tuple[str, ClipRequest, Path]) -> None:
    name, request, folder = job
    torch.set_num_threads(1)
    clip = generate_clip(find_robot(name), request, round(SEGMENT_S / CONTROL_S) + 1)
    save_clip(_path(request, folder), clip)


def policy_walks(run: Run, folder: Path) -> list[ClipFeatures]:
    """The policy's own walks of every skill at COMMANDS, as its skill discriminator sees them, from WALK_S[0] s on.

    A walk that falls is left out. Raises NoLatentSpaceError for a run without a skill discriminator.
    """
    features_of(run, [])  # is there one at all?
    assert run.skill_prior is not None
    env, skills = run.config.env, run.config.motion.skill_set()
    ages, period = env.transition_ages, env.control_period_s
    first = round(WALK_S[0] / period)
    label = torch.arange(len(skills)).repeat_interleave(len(COMMANDS))
    steps = round(sum(WALK_S) / period)
    walked = walk(run, folder, "walks", label[:, None].repeat(1, steps), list(COMMANDS) * len(skills))
    states = [walked.amp_state, walked.foot_stance] if env.foot_stance else [walked.amp_state]
    seen = torch.from_numpy(np.concatenate(states, axis=-1)[:, first:])
    found = []
    for row in np.flatnonzero(~walked.fallen):
        shown = transitions(seen[row], ages)
        feature = run.skill_prior.predict(Transition(shown, torch.zeros(len(shown), dtype=torch.int64)))
        skill, contact = skills[walked.skill[row, 0]], walked.step_contact[row, first:]
        measured = float(measure_gait(contact[None], period).frequency_hz[0])
        frequency = skill.frequency_hz or (measured if np.isfinite(measured) else USUAL_HZ)
        touchdown = first_touchdown(contact[ages[0] - 1 :, 0])
        found.append(ClipFeatures(skill.gait, frequency, walked.command[row], feature.numpy(), touchdown, period))
    return found


def segment_features(run: Run, folder: Path = FOLDER) -> list[ClipFeatures]:
    """The skill discriminator's features of the reference segments, as `analysis.load` gives those of clips."""
    return features_of(run, reference_segments(run, folder))
