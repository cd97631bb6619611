"""What a simulator offers the environment, whatever it runs on."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Protocol, Self

import torch
from torch import Tensor

from camp.robots import go2


@dataclass
class RobotState:
    """The state of N robots after a control step, float32 on the simulator's device.

    Legs in the order of ``FOOT_NAMES``, joints in that of ``JOINT_NAMES``.
    """

    base_position: Tensor  # (N, 3) m, world frame
    base_quaternion: Tensor  # (N, 4) w first, base to world
    base_linear_velocity: Tensor  # (N, 3) m/s, world frame
    base_angular_velocity: Tensor  # (N, 3) rad/s, base frame
    joint_position: Tensor  # (N, 12) rad
    joint_velocity: Tensor  # (N, 12) rad/s
    foot_force: Tensor  # (N, 4, 3) N, ground on foot, world frame
    body_force: Tensor  # (N, 5, 3) N, ground on base and the four thighs, world frame

    def take(self, rows: Tensor | slice) -> Self:
        """The robots ``rows``."""
        return type(self)(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})

    def qpos(self) -> Tensor:
        """(N, 19) MuJoCo's generalized position: base position, base quaternion, joint positions."""
        return torch.cat([self.base_position, self.base_quaternion, self.joint_position], dim=1)


@dataclass
class InitialState:
    """Where n robots start, float32."""

    base_position: Tensor  # (n, 3) m, world frame
    base_quaternion: Tensor  # (n, 4) w first
    base_linear_velocity: Tensor  # (n, 3) m/s, world frame
    base_angular_velocity: Tensor  # (n, 3) rad/s, base frame
    joint_position: Tensor  # (n, 12) rad
    joint_velocity: Tensor  # (n, 12) rad/s


# Bodies whose mass "link mass" randomization scales: the trunk and the three links of each leg.
LINK_NAMES = ("base", *(f"{leg}_{kind}" for leg in go2.FOOT_NAMES for kind in go2.JOINT_KINDS))


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

    @classmethod
    def nominal(cls, num: int, friction: float, device: torch.device) -> Self:
        """n robots as published, without payload."""
        one = torch.ones(num, go2.NUM_JOINTS, device=device)
        return cls(
            link_mass_scale=torch.ones(num, len(LINK_NAMES), device=device),
            payload_mass=torch.zeros(num, device=device),
            payload_position=torch.zeros(num, 3, device=device),
            friction=torch.full((num,), friction, device=device),
            motor_strength=one.clone(),
            kp_scale=one.clone(),
            kd_scale=one.clone(),
        )

    def tensors(self) -> dict[str, Tensor]:
        """Name to tensor, without copies."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def assign(self, env_ids: Tensor, other: Dynamics) -> None:
        """Overwrite the rows ``env_ids`` with those of ``other``."""
        for name, tensor in self.tensors().items():
            tensor[env_ids] = getattr(other, name)

    def take(self, rows: Tensor | slice) -> Self:
        """The robots ``rows``."""
        return type(self)(**{name: tensor[rows] for name, tensor in self.tensors().items()})


class Simulator(Protocol):
    """N robots on flat ground, stepped together at the control rate.

    Joint targets go through a PD law inside the simulator: at every physics step the torque is
    strength * (kp_scale kp (target - q) - kd_scale kd q'), clipped at the joint's torque limit.
    """

    num_envs: int
    device: torch.device
    control_period: float  # s

    @property
    def state(self) -> RobotState:
        """The current state; forces are those at the beginning of the last physics step."""
        ...

    def step(self, joint_target: Tensor) -> None:
        """Hold the joint targets (N, 12) in rad for one control period."""
        ...

    def reset(self, env_ids: Tensor, initial: InitialState) -> None:
        """Put the robots ``env_ids`` (n,), sorted and unique, into a state; the others are untouched."""
        ...

    def set_dynamics(self, env_ids: Tensor, dynamics: Dynamics) -> None:
        """Give the robots ``env_ids`` (n,), sorted and unique, other physical parameters."""
        ...

    def push(self, velocity_change: Tensor) -> None:
        """Add to the linear velocity of every base, (N, 3) m/s, world frame."""
        ...

    def diverged(self) -> Tensor:
        """(N,) bool: robots whose state is no longer finite. They stay so until they are reset."""
        ...

    def state_dict(self) -> dict[str, Any]:
        """Everything a bit-for-bit continuation needs, but for the dynamics."""
        ...

    def load_state_dict(self, state: dict[str, Any]) -> None: ...

    def close(self) -> None: ...
