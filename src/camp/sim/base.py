"""The interface of simulators to the environment."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Protocol, Self

import mujoco
import torch
from torch import Tensor

from camp.robots.quadruped import FOOT_NAMES, JOINT_KINDS, NUM_JOINTS, NUM_LEGS
from camp.robots.robot import Robot

NUM_FELT_BODIES = 1 + NUM_LEGS  # base and thighs, whose ground reactions the model's sensors report


@dataclass
class InitialState:
    """Where n robots start, float32.

    Legs in the order of ``FOOT_NAMES``, joints in that of ``JOINT_NAMES``.
    """

    base_position: Tensor  # (n, 3) m, world frame
    base_quaternion: Tensor  # (n, 4) w first, base to world
    base_linear_velocity: Tensor  # (n, 3) m/s, world frame
    base_angular_velocity: Tensor  # (n, 3) rad/s, base frame
    joint_position: Tensor  # (n, 12) rad
    joint_velocity: Tensor  # (n, 12) rad/s

    @classmethod
    def from_model(cls, qpos: Tensor, qvel: Tensor) -> InitialState:
        """Views of MuJoCo's generalized positions (n, 19) and velocities (n, 18)."""
        return InitialState(qpos[:, 0:3], qpos[:, 3:7], qvel[:, 0:3], qvel[:, 3:6], qpos[:, 7:], qvel[:, 6:])

    @classmethod
    def standing(cls, model: mujoco.MjModel, num: int, device: torch.device) -> InitialState:
        """``num`` robots at rest in the model's keyframe "stand"."""
        qpos = torch.tensor(model.key("stand").qpos, dtype=torch.float32, device=device).expand(num, -1)
        return cls.from_model(qpos, torch.zeros(num, model.nv, device=device))

    def qpos(self) -> Tensor:
        """(n, 19) MuJoCo's generalized position: base position, base quaternion, joint positions."""
        return torch.cat([self.base_position, self.base_quaternion, self.joint_position], dim=1)

    def qvel(self) -> Tensor:
        """(n, 18) MuJoCo's generalized velocity: linear and angular velocity of the base, joint velocities."""
        return torch.cat([self.base_linear_velocity, self.base_angular_velocity, self.joint_velocity], dim=1)

    def replaced(self, mask: Tensor, other: Self) -> Self:
        """Row by row ``other`` where ``mask`` (n,) bool holds, else these."""
        return type(self)(**{name: select(mask, getattr(other, name), mine) for name, mine in vars(self).items()})

    def robot_state(self) -> RobotState:
        """What a simulator reports right after a reset into this state: no force has been felt yet."""
        num, device = len(self.base_position), self.base_position.device
        return RobotState(
            **vars(self),
            foot_force=torch.zeros(num, NUM_LEGS, 3, device=device),
            body_force=torch.zeros(num, NUM_FELT_BODIES, 3, device=device),
            foot_stance=torch.zeros(num, NUM_LEGS, device=device),
        )


@dataclass
class RobotState(InitialState):
    """The state of n robots after a control step, float32 on the simulator's device."""

    foot_force: Tensor  # (n, 4, 3) N, ground on foot, world frame
    body_force: Tensor  # (n, 5, 3) N, ground on base and the four thighs, world frame
    foot_stance: Tensor  # (n, 4) fraction of the control step's physics steps in which the foot carried load

    @classmethod
    def measured(cls, qpos: Tensor, qvel: Tensor, sensordata: Tensor, foot_stance: Tensor) -> RobotState:
        """Views of what the model holds: (n, 19) positions, (n, 18) velocities, (n, 27) contact sensors; and of
        ``foot_stance``."""
        # The sensors give the force of the first geom on the second; the reaction acts on the robot.
        force = -sensordata.unflatten(1, (-1, 3))
        placed = vars(InitialState.from_model(qpos, qvel))
        return cls(**placed, foot_force=force[:, :NUM_LEGS], body_force=force[:, NUM_LEGS:], foot_stance=foot_stance)


# Bodies whose mass "link mass" randomization scales: the trunk and the three links of each leg.
LINK_NAMES = ("base", *(f"{leg}_{kind}" for leg in FOOT_NAMES for kind in JOINT_KINDS))


@dataclass
class Dynamics:
    """The physical parameters of n robots that domain randomization varies (paper, Table I), float32."""

    link_mass_scale: Tensor  # (n, 13) times the nominal mass and inertia, order of LINK_NAMES
    payload_mass: Tensor  # (n,) kg
    payload_position: Tensor  # (n, 3) m, base frame
    friction: Tensor  # (n,) foot-ground coefficient
    motor_strength: Tensor  # (n, 12) times the torque the PD law asks for
    kp_scale: Tensor  # (n, 12) times the nominal gain
    kd_scale: Tensor  # (n, 12) times the nominal gain
    delay: Tensor  # (n,) s, by which joint targets reach the motors late; not in Table I

    @classmethod
    def nominal(cls, num: int, friction: float, device: torch.device) -> Self:
        """n robots as published, without payload."""
        one = torch.ones(num, NUM_JOINTS, device=device)
        return cls(
            link_mass_scale=torch.ones(num, len(LINK_NAMES), device=device),
            payload_mass=torch.zeros(num, device=device),
            payload_position=torch.zeros(num, 3, device=device),
            friction=torch.full((num,), friction, device=device),
            motor_strength=one.clone(),
            kp_scale=one.clone(),
            kd_scale=one.clone(),
            delay=torch.zeros(num, device=device),
        )

    @classmethod
    def from_tensors(cls, tensors: dict[str, Tensor]) -> Self:
        """The inverse of `tensors`; without delays where they were saved before there were any."""
        return cls(**({"delay": torch.zeros_like(tensors["friction"])} | tensors))

    def tensors(self) -> dict[str, Tensor]:
        """Name to tensor, without copies."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def take(self, rows: Tensor) -> Self:
        """The robots ``rows``, (m,) int64."""
        return type(self)(**{name: tensor[rows] for name, tensor in self.tensors().items()})

    def replaced(self, mask: Tensor, other: Self) -> Self:
        """Row by row ``other`` where ``mask`` (n,) bool holds, else these."""
        return type(self)(**{name: select(mask, getattr(other, name), mine) for name, mine in self.tensors().items()})


def select(mask: Tensor, chosen: Tensor, other: Tensor) -> Tensor:
    """Row by row ``chosen`` (n, ...) where ``mask`` (n,) bool holds, else ``other``."""
    return torch.where(mask.view(-1, *(1,) * (chosen.dim() - 1)), chosen, other)


class Simulator(Protocol):
    """N copies of one robot on flat ground, stepped together at the control rate; all tensors are on ``device``.

    Joint targets go through a PD law inside the simulator: at every physics step the torque is
    strength * (kp_scale kp (target - q) - kd_scale kd q'), clipped at the joint's torque limit. A robot's targets reach
    its motors ``Dynamics.delay`` late, rounded to physics steps.

    On an accelerator none of the methods that are called at every step makes the host wait for it.
    """

    robot: Robot  # with the nominal gains of the PD law
    num_envs: int
    device: torch.device
    control_period: float  # s

    @property
    def state(self) -> RobotState:
        """A copy of the current state; forces are those at the beginning of the last physics step, 0 after a
        reset; ``foot_stance`` is 0 after a reset and after ``load_state_dict``."""
        ...

    def step(self, joint_target: Tensor) -> None:
        """Hold the joint targets (N, 12) in rad for one control period."""
        ...

    def prepare(self, dynamics: Dynamics) -> None:
        """The physical parameters that each of the N robots takes on when it is next reset."""
        ...

    def reset(self, mask: Tensor, initial: InitialState, held: Tensor | None = None) -> None:
        """Put the robots of ``mask`` (N,) bool into their rows of ``initial`` (of all N), with the physical
        parameters prepared for them; the others are untouched.

        held: (N, 12) rad, the joint targets that the motors go on with until the first one arrives, where it is late;
        None: the joint positions.
        """
        ...

    def push(self, velocity_change: Tensor) -> None:
        """Add to the linear velocity of every base, (N, 3) m/s, world frame."""
        ...

    def verify(self) -> None:
        """Raise SimulationError if anything since the start could not be simulated as modelled.

        May wait for the device: call it once per rollout.
        """
        ...

    def state_dict(self) -> dict[str, Any]:
        """Everything a bit-for-bit continuation needs, but for the dynamics."""
        ...

    def load_state_dict(self, state: dict[str, Any]) -> None: ...
