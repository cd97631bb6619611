"""The paper's 10-s sequence: one policy, one command, one skill of each gait after the other (Sec. IV-D)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch

from analysis.nominal_walks import walk
from camp.build import Run
from camp.evaluation.recording import Recording
from camp.gaits.skills import split_name

COMMAND = (0.6, 0.0, 0.0)  # vx, vy in m/s, yaw rate in rad/s
SKILL_S = 2.5  # of each skill; paper: 10 s for four
PREFERRED_HZ = 3.0


def one_skill_of_each_gait(skills: Sequence[str]) -> list[str]:
    """In the order of the labels, each at PREFERRED_HZ, or else at the frequency that is nearest to it."""
    gaits = dict.fromkeys(split_name(skill)[0] for skill in skills)
    chosen = []
    for gait in gaits:
        own = [skill for skill in skills if split_name(skill)[0] == gait]
        chosen.append(min(own, key=lambda skill: abs((split_name(skill)[1] or PREFERRED_HZ) - PREFERRED_HZ)))
    return chosen


def roll_sequence(run: Run, folder: Path) -> Recording:
    """One nominal robot walks the sequence from standing, by the deterministic policy."""
    labels = torch.tensor([run.skills.index(skill) for skill in one_skill_of_each_gait(run.skills)])
    steps = round(SKILL_S / run.config.env.control_period_s)
    return walk(run, folder, "sequence", labels.repeat_interleave(steps)[None], [COMMAND])
