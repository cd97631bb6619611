"""MuJoCo on the CPU: N simulations of one model on a thread pool (``mujoco.batch``)."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import torch
from mujoco.batch import Batch
from torch import Tensor

from camp.robots.quadruped import CONTACT_FORCE, NUM_LEGS
from camp.robots.robot import Robot
from camp.sim.base import Dynamics, InitialState, RobotState
from camp.sim.delay import DelayLine
from camp.sim.parameters import FIELD_NAMES, ModelFields, nominal_friction

# The rows that make up a simulation between two control steps (mjSTATE_INTEGRATION without the unused parts).
_STATE_FIELDS = ("time", "qpos", "qvel", "qacc_warmstart", "ctrl")
_FEET = 3 * NUM_LEGS  # values of the feet's force sensors, which come first


class CpuSimulator:
    """The ``Simulator`` protocol on ``mujoco.batch.Batch``; bit-identical at any number of threads.

    Args:
        robot: with the nominal PD gains.
        num_envs: number of robots.
        control_period: s, held target per ``step``; a multiple of ``physics_timestep``.
        physics_timestep: s.
        threads: simulation threads, 0 for one per processor.
    """

    def __init__(self, robot: Robot, num_envs: int, control_period: float, physics_timestep: float, threads: int):
        self.robot = robot
        self.num_envs = num_envs
        self.device = torch.device("cpu")
        self.control_period = control_period
        self.model = robot.load_model(physics_timestep)
        # MuJoCo would silently reset a simulation that diverges; it must stay visible instead.
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.substeps = round(control_period / physics_timestep)
        self._delays = DelayLine(num_envs, control_period, physics_timestep, self.device)
        self._no_delay = True
        self._batch = Batch(self.model, nsim=num_envs, nthread=threads)
        self._rows = {name: self._batch.bind(name) for name in _STATE_FIELDS}
        self._sensordata = self._batch.bind("sensordata")
        # Sensor values live in a copy of our own, so that a loaded checkpoint can restore them.
        self._forces = np.zeros((num_envs, self.model.nsensordata), dtype=np.float32)
        # What lasts a few milliseconds, such as the flight of a bound, is missed at the control rate.
        self.contact = np.zeros((num_envs, self.substeps, NUM_LEGS), dtype=bool)  # in the last control step
        self._fields = ModelFields(self.model, robot, self.device)
        self._dynamics_rows = {name: self._batch.expand(name) for name in FIELD_NAMES}
        self.prepare(Dynamics.nominal(num_envs, nominal_friction(self.model), self.device))
        self._take_on_dynamics(np.arange(num_envs))
        self._batch.reset(keyframe=self.model.key("stand").id)

    @property
    def state(self) -> RobotState:
        qpos = torch.from_numpy(self._rows["qpos"].astype(np.float32))
        qvel = torch.from_numpy(self._rows["qvel"].astype(np.float32))
        return RobotState.measured(qpos, qvel, torch.from_numpy(self._forces.copy()), self._foot_stance())

    def step(self, joint_target: Tensor) -> None:
        self._delays.send(joint_target)
        for step in range(self.substeps):
            if step == 0 or not self._no_delay:
                self._rows["ctrl"][:] = self._delays.arrived(step).numpy(force=True)
            self._batch.step(nstep=1)
            force = self._sensordata[:, :_FEET].reshape(-1, NUM_LEGS, 3)
            self.contact[:, step] = np.einsum("nfi,nfi->nf", force, force) > CONTACT_FORCE**2
        self._forces[:] = self._sensordata

    def prepare(self, dynamics: Dynamics) -> None:
        self._prepared = dynamics

    def reset(self, mask: Tensor, initial: InitialState, held: Tensor | None = None) -> None:
        ids = mask.nonzero().squeeze(1).numpy()
        if len(ids) == 0:
            return
        self._take_on_dynamics(ids)
        self._batch.reset(ids, stage=mujoco.mjtStage.mjSTAGE_NONE)
        self._rows["qpos"][ids] = initial.qpos().numpy(force=True)[ids]
        self._rows["qvel"][ids] = initial.qvel().numpy(force=True)[ids]
        self._rows["ctrl"][ids] = initial.joint_position.numpy(force=True)[ids]
        self._forces[ids] = 0.0
        self.contact[ids] = False
        self._delays.restart(mask, initial.joint_position if held is None else held, self._prepared.delay)
        self._no_delay = self._delays.idle()

    def push(self, velocity_change: Tensor) -> None:
        self._rows["qvel"][:, 0:3] += velocity_change.numpy(force=True)

    def verify(self) -> None:
        """Contact and constraint buffers grow as needed: nothing is ever left out."""

    def state_dict(self) -> dict[str, Any]:
        state: dict[str, Any] = {name: torch.from_numpy(rows.copy()) for name, rows in self._rows.items()}
        state["forces"] = torch.from_numpy(self._forces.copy())
        state["delays"] = self._delays.state_dict()
        return state

    def load_state_dict(self, state: dict[str, Any]) -> None:
        for name, rows in self._rows.items():
            rows[:] = state[name].numpy()
        self._forces[:] = state["forces"].numpy()
        self.contact[:] = False
        if "delays" in state:  # absent where it was saved before there were delays
            self._delays.load_state_dict(state["delays"])
            self._no_delay = self._delays.idle()

    def _foot_stance(self) -> Tensor:
        return torch.from_numpy(self.contact.mean(axis=1, dtype=np.float32))

    def _take_on_dynamics(self, ids: np.ndarray) -> None:
        """Give the robots ``ids`` (n,), sorted and unique, the physical parameters prepared for them."""
        for name, value in self._fields.of(self._prepared.take(torch.from_numpy(ids))).items():
            self._dynamics_rows[name][ids] = value.numpy()
        self._batch.set_const(ids)
