"""Rolling policies out as planned, all robots at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from camp.common.progress import Track, silently
from camp.common.seeding import generator
from camp.envs.config import NoiseConfig, TerminationConfig
from camp.envs.measurement import Measurement, measure
from camp.envs.terminations import failed
from camp.evaluation.controllers import Controller, Sight
from camp.evaluation.plan import Plan, joined
from camp.robots.robot import Robot
from camp.sim.base import InitialState, RobotState
from camp.sim.cpu import CpuSimulator
from camp.sim.divergence import diverged

FALL = TerminationConfig(body_contact_force_n=1.0, tilt_rad=0.8)  # as in training; AMP on A1
Floats = NDArray[np.floating]


@dataclass(frozen=True)
class Setting:
    """What all robots of a batch have in common."""

    period_s: float
    robot: Robot  # with the policy's nominal gains
    noise: NoiseConfig
    push_period_s: float
    seed: int
    timestep_s: float = 0.005
    threads: int = 0


@dataclass
class Trace:
    """What the R robots of a plan did over its T control steps; C contacts of each foot per control step.

    From its first fall on a robot lies still: no contacts, no speed, its last pose.
    """

    setting: Setting
    plan: Plan
    qpos: Floats  # (R, T + 1, 19) from the start on
    qvel: Floats  # (R, T + 1, 18)
    joint_target: Floats  # (R, T, 12) rad, that the policy asked for
    contact: NDArray[np.bool_]  # (R, T C, 4), True where the foot carries more than 1 N
    steps_upright: NDArray[np.integer]  # (R,) T where it never fell


def roll_out(jobs: Sequence[tuple[Plan, Controller]], setting: Setting, track: Track = silently) -> list[Trace]:
    """Run every plan by its controller, all in one batch; what one plan draws at random does not depend on another."""
    whole = joined("batch", [plan for plan, _ in jobs])
    ends = np.cumsum([len(plan) for plan, _ in jobs]).tolist()
    groups = [
        (slice(end - len(plan), end), plan, controller, _Disturbances(plan, setting))
        for end, (plan, controller) in zip(ends, jobs, strict=True)
    ]
    num, steps = len(whole), whole.steps
    sim = CpuSimulator(setting.robot, num, setting.period_s, setting.timestep_s, setting.threads)
    sim.prepare(whole.dynamics)
    sim.reset(torch.ones(num, dtype=torch.bool), whole.starts.initial, whole.starts.joint_target)
    for rows, _, controller, _ in groups:
        controller.start(whole.starts.joint_target[rows])
    notes = _Notes(num, steps, sim)
    target, change = torch.zeros(num, 12), torch.zeros(num, 3)
    floor = InitialState.standing(sim.model, num, sim.device)  # where those that fell lie from then on
    held = whole.starts.joint_target.clone()
    for step in track(range(steps), "walking, control steps"):
        true = measure(setting.robot, sim.state)
        for rows, _, controller, disturbances in groups:
            seen = disturbances.sensed(_rows(true, rows))
            sight = Sight(seen, whole.command[rows], whole.skill[rows, step], step * setting.period_s)
            with torch.no_grad():
                target[rows] = controller(sight)
            held[rows] = disturbances.arriving(target[rows], held[rows])
            change[rows] = disturbances.push(step)
        sim.push(change)
        sim.step(held)
        state = sim.state
        fell = failed(measure(setting.robot, state), diverged(setting.robot, state), FALL)
        notes.take(step, target, sim, fell)
        if fell.any():
            sim.reset(fell, floor)
    return [notes.trace(setting, plan, rows) for rows, plan, _, _ in groups]


class _Notes:
    """What happens, step by step, of all robots."""

    def __init__(self, num: int, steps: int, sim: CpuSimulator):
        self.upright = np.full(num, steps)
        self.qpos, self.qvel = np.empty((num, steps + 1, 19), np.float32), np.empty((num, steps + 1, 18), np.float32)
        self.target = np.empty((num, steps, 12), np.float32)
        self.contact = np.empty((num, steps, sim.substeps, 4), dtype=bool)
        self._state(0, sim.state)

    def _state(self, row: int, state: RobotState) -> None:
        self.qpos[:, row] = state.qpos()
        self.qvel[:, row] = state.qvel()

    def take(self, step: int, target: Tensor, sim: CpuSimulator, fell: Tensor) -> None:
        self.upright = np.where(fell.numpy(), np.minimum(self.upright, step), self.upright)
        self.target[:, step], self.contact[:, step] = target, sim.contact
        self._state(step + 1, sim.state)

    def trace(self, setting: Setting, plan: Plan, rows: slice) -> Trace:
        """The part of one plan, its fallen robots lying still."""
        steps = plan.steps
        qpos, qvel = self.qpos[rows, : steps + 1], self.qvel[rows, : steps + 1]
        target, contact = self.target[rows, :steps], self.contact[rows, :steps]
        upright = np.minimum(self.upright[rows], steps)
        for robot in np.flatnonzero(upright < steps):
            last = upright[robot]
            contact[robot, last:], qvel[robot, last + 1 :] = False, 0.0
            qpos[robot, last + 1 :], target[robot, last:] = qpos[robot, last], target[robot, max(last - 1, 0)]
        return Trace(setting, plan, qpos, qvel, target, contact.reshape(len(plan), -1, 4), upright)


class _Disturbances:
    """Sensor noise, pushes and lost targets of one plan's robots."""

    def __init__(self, plan: Plan, setting: Setting):
        self._trouble, self._setting = plan.disturbances, setting
        self._steps = max(1, round(setting.push_period_s / setting.period_s))
        self._noise, self._pushes, self._losses = (
            generator(setting.seed, f"evaluation/{plan.name}/{what}") for what in ("noise", "pushes", "losses")
        )

    def sensed(self, true: Measurement) -> Measurement:
        """What the sensors tell the policy."""
        if not self._trouble.noise.any():
            return true
        width = self._setting.noise
        return replace(
            true,
            angular_velocity=self._noisy(true.angular_velocity, width.angular_velocity_rad_s),
            gravity=self._noisy(true.gravity, width.gravity),
            joint_position=self._noisy(true.joint_position, width.joint_position_rad),
            joint_velocity=self._noisy(true.joint_velocity, width.joint_velocity_rad_s),
        )

    def _noisy(self, value: Tensor, width: float) -> Tensor:
        draw = torch.rand(value.shape, generator=self._noise) * 2.0 - 1.0
        return value + width * self._trouble.noise[:, None] * draw

    def arriving(self, sent: Tensor, held: Tensor) -> Tensor:
        """The targets (R, 12) that the motors get: the latest, or the one before where it was lost."""
        if not self._trouble.loss.any():
            return sent
        lost = torch.rand(len(sent), generator=self._losses) < self._trouble.loss
        return torch.where(lost[:, None], held, sent)

    def push(self, step: int) -> Tensor:
        """Change of each base's velocity, (R, 3) m/s."""
        size = self._trouble.push_m_s
        if step == 0 or step % self._steps or not size.any():
            return torch.zeros(len(size), 3)
        angle = 2.0 * torch.pi * torch.rand(len(size), generator=self._pushes)
        return torch.stack([torch.cos(angle), torch.sin(angle), torch.zeros_like(angle)], 1) * size[:, None]


def _rows(measurement: Measurement, rows: slice) -> Measurement:
    return Measurement(**{name: value[rows] for name, value in vars(measurement).items()})
