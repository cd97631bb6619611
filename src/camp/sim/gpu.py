"""MuJoCo Warp: N worlds of one model on a CUDA GPU or, slowly and for tests, on Warp's CPU device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import mujoco_warp as mjw
import torch
import warp as wp
from torch import Tensor

from camp.common.errors import SimulationError
from camp.robots.quadruped import CONTACT_FORCE, NUM_LEGS
from camp.robots.robot import Robot
from camp.sim.base import Dynamics, InitialState, RobotState, select
from camp.sim.cuda_graph import CudaGraph
from camp.sim.delay import DelayLine
from camp.sim.parameters import FIELD_NAMES, ModelFields, nominal_friction

wp.config.log_level = wp.LOG_WARNING  # or every kernel would be announced

# What MuJoCo derives from the fields that differ from robot to robot.
_DERIVED_NAMES = ("body_subtreemass", "dof_invweight0", "body_invweight0", "actuator_acc0")
_CONTACT_OVERFLOW = mjw.OverflowType.BROADPHASE | mjw.OverflowType.NARROWPHASE | mjw.OverflowType.CCD
_CONSTRAINT_OVERFLOW = mjw.OverflowType.NEFC | mjw.OverflowType.NJMAX_NNZ


@dataclass(frozen=True)
class WarpSettings:
    """Where Warp runs and what it sets aside."""

    device: torch.device  # a CUDA device with its index, or the CPU
    contacts_per_robot: int  # on average over all robots
    constraints_per_robot: int  # rows of the constraint solver, for each robot


class GpuSimulator:
    """The ``Simulator`` protocol on ``mujoco_warp``; float32, its arrays are shared with torch without copies.

    Args:
        robot: with the nominal PD gains.
        num_envs: number of robots.
        control_period: s, held target per ``step``; a multiple of ``physics_timestep``.
        physics_timestep: s.
        settings: device and buffer sizes.
    """

    def __init__(
        self,
        robot: Robot,
        num_envs: int,
        control_period: float,
        physics_timestep: float,
        settings: WarpSettings,
    ):
        self.robot = robot
        self.num_envs = num_envs
        self.device = settings.device
        self.control_period = control_period
        self.model = robot.load_model(physics_timestep)
        self._settings = settings
        batched = dict.fromkeys((*FIELD_NAMES, *_DERIVED_NAMES), num_envs)
        with wp.ScopedDevice(str(self.device)):
            model = mjw.put_model(self.model, batch_sizes=batched)
            data = mjw.make_data(
                self.model,
                nworld=num_envs,
                nconmax=settings.contacts_per_robot,
                njmax=settings.constraints_per_robot,
            )
        # Kernels could only print an overflow; `verify` raises it.
        model.opt.warn_overflow = 0
        self._qpos, self._qvel, self._ctrl = (wp.to_torch(array) for array in (data.qpos, data.qvel, data.ctrl))
        self._acceleration = wp.to_torch(data.qacc_warmstart)  # where the constraint solver begins
        self._sensordata = wp.to_torch(data.sensordata)
        self._overflow = wp.to_torch(data.overflow)
        self._next_dynamics = _NextDynamics(self.model, num_envs, robot, self.device)
        self._dynamics = {name: wp.to_torch(getattr(model, name)) for name in batched}
        self._substeps = round(control_period / physics_timestep)
        self._loaded = torch.zeros(num_envs, NUM_LEGS, device=self.device)  # physics steps of the last control step
        self._delays = DelayLine(num_envs, control_period, physics_timestep, self.device)

        self.physics = CudaGraph(lambda: mjw.step(model, data), self.device)
        self._overflow.zero_()
        self.prepare(Dynamics.nominal(num_envs, nominal_friction(self.model), self.device))
        everyone = torch.ones(num_envs, dtype=torch.bool, device=self.device)
        self.reset(everyone, InitialState.standing(self.model, num_envs, self.device))

    @property
    def state(self) -> RobotState:
        return RobotState.measured(
            self._qpos.clone(), self._qvel.clone(), self._sensordata, self._loaded / self._substeps
        )

    def step(self, joint_target: Tensor) -> None:
        self._delays.send(joint_target)
        self._loaded.zero_()
        for step in range(self._substeps):
            self._ctrl.copy_(self._delays.arrived(step))
            self.physics.run()
            force = self._sensordata[:, : 3 * NUM_LEGS].unflatten(1, (NUM_LEGS, 3))
            self._loaded += force.norm(dim=-1) > CONTACT_FORCE

    def prepare(self, dynamics: Dynamics) -> None:
        self._next_dynamics.prepare(dynamics)
        self._next_delay = dynamics.delay

    def reset(self, mask: Tensor, initial: InitialState, held: Tensor | None = None) -> None:
        for name, prepared in self._next_dynamics.fields.items():
            _replace(self._dynamics[name], mask, prepared)
        _replace(self._qpos, mask, initial.qpos())
        _replace(self._qvel, mask, initial.qvel())
        _replace(self._ctrl, mask, initial.joint_position)
        self._acceleration.masked_fill_(mask[:, None], 0.0)
        self._sensordata.masked_fill_(mask[:, None], 0.0)
        self._loaded.masked_fill_(mask[:, None], 0.0)
        self._delays.restart(mask, initial.joint_position if held is None else held, self._next_delay)

    def push(self, velocity_change: Tensor) -> None:
        self._qvel[:, 0:3] += velocity_change

    def verify(self) -> None:
        settings = self._settings
        flags = (int(_CONTACT_OVERFLOW), int(_CONSTRAINT_OVERFLOW))
        contacts, constraints = torch.stack([(self._overflow & flag).any() for flag in flags]).tolist()
        for overflowed, key, value, what in (
            (contacts, "contacts_per_robot", settings.contacts_per_robot, "contacts"),
            (constraints, "constraints_per_robot", settings.constraints_per_robot, "constraints of a robot"),
        ):
            if overflowed:
                raise SimulationError(
                    f"sim.{key} = {value}: more {what} came up and were left out of the physics; "
                    f"start again with a higher number, such as sim.{key}={2 * value}"
                )

    def state_dict(self) -> dict[str, Any]:
        state: dict[str, Any] = {name: tensor.clone() for name, tensor in self._state().items()}
        return state | {"delays": self._delays.state_dict()}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        for name, tensor in self._state().items():
            tensor.copy_(state[name])
        self._loaded.zero_()
        if "delays" in state:  # absent where it was saved before there were delays
            self._delays.load_state_dict(state["delays"])

    def _state(self) -> dict[str, Tensor]:
        return {
            "qpos": self._qpos,
            "qvel": self._qvel,
            "qacc_warmstart": self._acceleration,
            "ctrl": self._ctrl,
            "forces": self._sensordata,
        }


class _NextDynamics:
    """The model's fields behind the physical parameters that robots take on at their next reset."""

    def __init__(self, model: mujoco.MjModel, num_envs: int, robot: Robot, device: torch.device):
        self._values = ModelFields(model, robot, device)
        names = (*FIELD_NAMES, *_DERIVED_NAMES)
        with wp.ScopedDevice(str(device)):
            prepared = mjw.put_model(model, batch_sizes=dict.fromkeys(names, num_envs))
            scratch = mjw.make_data(model, nworld=num_envs, nconmax=0, njmax=0)
        groups = int(mjw.SetConstGroup.FIXED | mjw.SetConstGroup.INERT0)
        self._derive = CudaGraph(lambda: mjw.set_const(prepared, scratch, groups, restore=False), device)
        self.fields = {name: wp.to_torch(getattr(prepared, name)) for name in names}  # (N, ...) each

    def prepare(self, dynamics: Dynamics) -> None:
        """Set the fields and what MuJoCo derives from them."""
        for name, value in self._values.of(dynamics).items():
            self.fields[name].copy_(value)
        self._derive.run()


def _replace(target: Tensor, mask: Tensor, values: Tensor) -> None:
    """Overwrite the rows of ``mask`` (N,) bool with those of ``values``, in place."""
    target.copy_(select(mask, values, target))
