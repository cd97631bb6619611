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
from camp.motion.clips.sampler import ReferenceState, ReferenceStates
from camp.robots.amp_state import AMP_STATE_SIZE
from camp.robots.robot import Robot
from camp.sim.base import Dynamics, InitialState

TOUCHING_M = 1e-3  # no higher is a foot that stands before the simulation begins


@dataclass
class Moment:
    """N robots at a control step before their episodes begin."""

    initial: InitialState
    joint_target: Tensor  # (N, 12) rad, what the PD law is taken to have held before


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
    earlier: list[Moment]  # the H - 1 control steps before, oldest first: what the policy observes of the past

    def state_dict(self) -> dict[str, Any]:
        """All but ``earlier``, which has been observed by then."""
        parts = {"initial": vars(self.initial), "dynamics": self.dynamics.tensors()}
        return {name: value for name, value in vars(self).items() if name != "earlier"} | parts

    @classmethod
    def from_state_dict(cls, state: dict[str, Any]) -> Self:
        parts = {
            "initial": InitialState(**state["initial"]),
            "dynamics": Dynamics.from_tensors(state["dynamics"]),
            "earlier": [],
        }
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
    standing start. Who is set into a clip has been in its frames before; who stands has stood."""
    init, num = config.initialization, len(skill)
    *before, reference = references.sample_path(skill, generator)
    at_reference = uniform((0.0, 1.0), (num,), generator) < init.reference_fraction
    standing = initialization.standing(robot, num, init, generator)
    command = sample_commands(num, config.command, generator)
    row = at_reference[:, None]
    pose = constant(robot.default_joint_position, command)

    def moment(reference: ReferenceState) -> Moment:
        initial = standing.replaced(at_reference, initialization.from_reference(reference))
        return Moment(initial, torch.where(row, reference.joint_target_applied_previous, pose))

    now = moment(reference)
    # Measured, not read: a clip's own last state may differ in the last digit. Who stands has stood before.
    measurement, stance = measure(robot, now.initial.robot_state()), None
    if config.foot_stance:
        touching = (foot_height(robot, measurement) < TOUCHING_M).float()
        stance = torch.where(row, reference.amp_history[:, -1, AMP_STATE_SIZE:], touching)
    present = discriminator_state(measurement, stance)[:, None]
    past = torch.where(row[..., None], reference.amp_history, present)
    # A robot set into a clip goes on with the clip's command, and remembers the clip's last target.
    return Starts(
        initial=now.initial,
        dynamics=dynamics,
        skill=skill,
        command=torch.where(row, reference.command, command),
        average_velocity=reference.command * row,
        joint_target=now.joint_target,
        amp_history=torch.cat([past[:, :-1], present], dim=1),
        earlier=[moment(one) for one in before],
    )
