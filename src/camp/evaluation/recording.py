"""A roll-out as the judge reads it: everything that follows from the robots' states, with units."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from camp.envs.measurement import foot_height, measure, sliding_speed
from camp.evaluation.rollout import Trace
from camp.metrics.contact import debounced
from camp.metrics.criteria import ContactLog
from camp.robots.quadruped import NUM_LEGS
from camp.sim.base import InitialState, RobotState
from camp.sim.motors import MotorLaw

Floats = NDArray[np.floating]


@dataclass
class Recording:
    """What R robots did over T control steps of ``period_s`` s; C contacts of each foot per control step.

    From its first fall on a robot counts as lying still: no speed, no contacts, no torques, its last pose.
    """

    period_s: float
    skill: NDArray[np.integer]  # (R, T) label commanded
    command: Floats  # (R, 3) vx, vy in m/s, yaw rate in rad/s
    velocity: Floats  # (R, T, 3) the same, reached at the step's end
    contact: NDArray[np.bool_]  # (R, T C, 4) as the sensors say, C times per control step
    foot_height: Floats  # (R, T, 4) m, lowest point above the ground, at the step's end, as the rest
    joint_target: Floats  # (R, T, 12) rad, held during the step
    joint_position: Floats  # (R, T, 12) rad
    joint_velocity: Floats  # (R, T, 12) rad/s
    torque: Floats  # (R, T, 2, 12) N m, when the target is set and at the step's end
    power: Floats  # (R, T) W, sum over the joints of |torque x velocity|, mean of these two moments
    foot_speed: Floats  # (R, T, 4) m/s over the ground
    amp_state: Floats  # (R, T, 43)
    qpos: Floats  # (R, T, 19) for pictures
    steps_upright: NDArray[np.integer]  # (R,) T where it never fell

    def __len__(self) -> int:
        return len(self.steps_upright)

    @property
    def steps(self) -> int:
        """T."""
        return self.velocity.shape[1]

    @property
    def contact_period_s(self) -> float:
        """s between contacts."""
        return self.period_s * self.steps / self.contact.shape[1]

    @property
    def fallen(self) -> NDArray[np.bool_]:
        """(R,) robots that fell."""
        return self.steps_upright < self.steps

    @cached_property
    def step_contact(self) -> NDArray[np.bool_]:
        """(R, T, 4) contacts at each control step's end, without the solver's breaks."""
        every = self.contact.shape[1] // self.steps
        return debounced(self.contact, self.contact_period_s)[:, every - 1 :: every]

    @cached_property
    def foot_stance(self) -> Floats:
        """(R, T, 4) fraction of each control step in which the foot stood, as `RobotState` has it."""
        num, steps = len(self), self.steps
        return self.contact.reshape(num, steps, -1, NUM_LEGS).mean(axis=2, dtype=np.float32)

    def log(self, first_step: int = 0) -> ContactLog:
        """Contacts and heights from a step on."""
        every = self.contact.shape[1] // self.steps
        contact, height = self.contact[:, first_step * every :], self.foot_height[:, first_step:]
        return ContactLog(contact, self.contact_period_s, height, self.period_s)

    def take(self, rows: slice | NDArray) -> Recording:
        """The robots ``rows``."""
        arrays = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "period_s"}
        return Recording(self.period_s, **{name: value[rows] for name, value in arrays.items()})


def record(trace: Trace) -> Recording:
    """Everything that follows from a trace."""
    num, steps = len(trace.plan), trace.plan.steps
    seen = measure(trace.setting.robot, _states(trace.qpos[:, 1:], trace.qvel[:, 1:]))
    position, velocity = torch.from_numpy(trace.qpos[..., 7:]), torch.from_numpy(trace.qvel[..., 6:])
    target, law = torch.from_numpy(trace.joint_target), MotorLaw.of(trace.setting.robot, trace.plan.dynamics)
    motors = MotorLaw(law.stiffness[:, None], law.damping[:, None], law.limit)  # the same at all times
    moments = [(position[:, k : k + steps], velocity[:, k : k + steps]) for k in (0, 1)]
    torques = [motors.torque(target, *moment) for moment in moments]
    power = sum((torque * moment[1]).abs().sum(dim=-1) for torque, moment in zip(torques, moments, strict=True)) / len(
        moments
    )
    assert isinstance(power, Tensor)
    gone = torch.from_numpy(np.arange(steps) >= trace.steps_upright[:, None])  # (R, T) after the fall

    def rows(value: Tensor) -> Floats:
        return value.reshape(num, steps, *value.shape[1:]).numpy()

    return Recording(
        period_s=trace.setting.period_s,
        skill=trace.plan.skill.numpy(),
        command=trace.plan.command.numpy(),
        velocity=rows(seen.velocity()),
        contact=trace.contact,
        foot_height=rows(foot_height(trace.setting.robot, seen)),
        joint_target=trace.joint_target,
        joint_position=trace.qpos[:, 1:, 7:],
        joint_velocity=trace.qvel[:, 1:, 6:],
        torque=torch.stack(torques, dim=2).masked_fill(gone[..., None, None], 0.0).numpy(),
        power=power.masked_fill(gone, 0.0).numpy(),
        foot_speed=rows(sliding_speed(trace.setting.robot, seen)),
        amp_state=rows(seen.amp_state()),
        qpos=trace.qpos[:, 1:],
        steps_upright=trace.steps_upright,
    )


def _states(qpos: Floats, qvel: Floats) -> RobotState:
    """All moments of all robots, one after the other; no force has a part in what is read."""
    position = torch.from_numpy(qpos.reshape(-1, qpos.shape[-1]))
    velocity = torch.from_numpy(qvel.reshape(-1, qvel.shape[-1]))
    return InitialState.from_model(position, velocity).robot_state()
