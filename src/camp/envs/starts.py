"""The start of an episode: state, physical parameters, command and skill of each robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import torch
from torch import Tensor

from camp.common.tensors import constant
from camp.envs import initialization
from camp.envs.commands import sample_commands, uniform
from camp.envs.config import EnvConfig
from camp.envs.measurement import foot_height, measure
from camp.envs.motion_history import discriminator_state
from camp.motion.clips.sampler import ReferenceStates
from camp.robots.amp_state import AMP_STATE_SIZE
from camp.robots.robot import Robot
from camp.sim.base import Dynamics, InitialState

TOUCHING_M = 1e-3  # no higher is a foot that stands before the simulation begins


@dataclass
class Starts:
    """The beginnings of N episodes."""

    initial: InitialState
    dynamics: Dynamics
    skill: Tensor  # (N,) int64
    command: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s
    average_velocity: Tensor  # (N, 3) the same, that the reward's average begins with
    joint_target: Tensor  # (N, 12) rad, what the PD law is taken to have held before
    amp_history: Tensor  # (N, A, S) the last A AMP states, its own the last

    def state_dict(self) -> dict[str, Any]:
        return vars(self) | {"initial": vars(self.initial), "dynamics": self.dynamics.tensors()}

    @classmethod
    def from_state_dict(cls, state: dict[str, Any]) -> Self:
        parts = {"initial": InitialState(**state["initial"]), "dynamics": Dynamics.from_tensors(state["dynamics"])}
        return cls(**(state | parts))


def draw_starts(
    robot: Robot,
    dynamics: Dynamics,
    skill: Tensor,
    config: EnvConfig,
    references: ReferenceStates,
    generator: torch.Generator,
) -> Starts:
    """Beginnings of N robots with these ``dynamics`` and labels (N,): a frame of one of the skill's clips, or a
    standing start."""
    init, num = config.initialization, len(skill)
    reference = references.sample(skill, generator)
    at_reference = uniform((0.0, 1.0), (num,), generator) < init.reference_fraction
    standing = initialization.standing(robot, num, init, generator)
    initial = standing.replaced(at_reference, initialization.from_reference(reference))
    command = sample_commands(num, config.command, generator)
    target = reference.joint_target_applied_previous
    row = at_reference[:, None]
    # Measured, not read: a clip's own last state may differ in the last digit. Who stands has stood before.
    measurement, stance = measure(robot, initial.robot_state()), None
    if config.foot_stance:
        touching = (foot_height(robot, measurement) < TOUCHING_M).float()
        stance = torch.where(row, reference.amp_history[:, -1, AMP_STATE_SIZE:], touching)
    present = discriminator_state(measurement, stance)[:, None]
    past = torch.where(row[..., None], reference.amp_history, present)
    # A robot set into a clip goes on with the clip's command, and remembers the clip's last target.
    return Starts(
        initial=initial,
        dynamics=dynamics,
        skill=skill,
        command=torch.where(row, reference.command, command),
        average_velocity=reference.command * row,
        joint_target=torch.where(row, target, constant(robot.default_joint_position, target)),
        amp_history=torch.cat([past[:, :-1], present], dim=1),
    )
