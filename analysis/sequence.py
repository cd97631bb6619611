"""The paper's 10-s sequence: one policy, one command, one skill of each gait after the other (Sec. IV-D)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch

from camp.build import Run
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.plan import ONE_SIZE, Disturbances, Plan
from camp.evaluation.recording import Recording, record
from camp.evaluation.rollout import Setting, roll_out
from camp.evaluation.sampling import standing_starts
from camp.evaluation.subjects import subject_of_run
from camp.gaits.skills import split_name
from camp.robots.registry import find_robot
from camp.sim.base import Dynamics

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
    evaluation = compose_evaluation()
    contract = subject_of_run(run, folder, "sequence", baselines=False)
    period = contract.contract.control_period_s
    order = one_skill_of_each_gait(run.skills)
    labels = torch.tensor([run.skills.index(skill) for skill in order])
    source = torch.Generator().manual_seed(0)
    robot = find_robot(run.config.robot.name)
    plan = Plan(
        "sequence",
        labels.repeat_interleave(round(SKILL_S / period))[None],
        torch.tensor([COMMAND]),
        standing_starts(robot, 1, ONE_SIZE, source),
        Dynamics.nominal(1, evaluation.randomization.nominal_friction, torch.device("cpu")),
        Disturbances.of(1),
    )
    setting = Setting(period, robot, evaluation.noise, evaluation.push_period_s, seed=0, threads=1)
    (trace,) = roll_out([(plan, contract.controller())], setting)
    return record(trace)
