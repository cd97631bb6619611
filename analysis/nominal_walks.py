"""Walks of a run's deterministic policy on nominal robots, from standing: what figures of its own motion show."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch
from torch import Tensor

from camp.build import Run, build_robot
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.plan import ONE_SIZE, Disturbances, Plan
from camp.evaluation.recording import Recording, record
from camp.evaluation.rollout import Setting, roll_out
from camp.evaluation.sampling import standing_starts
from camp.evaluation.subjects import subject_of_run
from camp.sim.base import Dynamics


def walk(run: Run, folder: Path, name: str, skill: Tensor, command: Sequence[tuple[float, float, float]]) -> Recording:
    """R robots with the run's gains and physics step, without noise and pushes.

    name: of the walks, for messages; skill: (R, T) labels of T control steps; command: R times vx, vy in m/s and yaw
    rate in rad/s.
    """
    evaluation, subject = compose_evaluation(), subject_of_run(run, folder, name, baselines=False)
    robot, num = build_robot(run.config.robot), len(skill)
    plan = Plan(
        name,
        skill,
        torch.tensor(command),
        standing_starts(robot, num, ONE_SIZE, torch.Generator().manual_seed(0)),
        Dynamics.nominal(num, evaluation.randomization.nominal_friction, torch.device("cpu")),
        Disturbances.of(num),
    )
    setting = Setting(
        run.config.env.control_period_s,
        robot,
        evaluation.noise,
        evaluation.push_period_s,
        seed=0,
        timestep_s=run.config.sim.physics_timestep_s,
        threads=1,
    )
    (trace,) = roll_out([(plan, subject.controller())], setting)
    return record(trace)
