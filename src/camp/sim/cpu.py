"""MuJoCo on the CPU: N simulations of one model on a thread pool (``mujoco.batch``)."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import torch
from mujoco.batch import Batch
from torch import Tensor

from camp.robots import go2
from camp.sim.base import LINK_NAMES, Dynamics, InitialState, RobotState

# The rows that make up a simulation between two control steps (mjSTATE_INTEGRATION without the unused parts).
_STATE_FIELDS = ("time", "qpos", "qvel", "qacc_warmstart", "ctrl")


class CpuSimulator:
    """The ``Simulator`` protocol on ``mujoco.batch.Batch``; bit-identical at any number of threads.

    Args:
        num_envs: number of robots.
        control_period: s, held target per ``step``; a multiple of ``physics_timestep``.
        physics_timestep: s.
        threads: simulation threads, 0 for one per processor.
        gains: nominal PD gains (kp, kd), each 12 values in N m/rad and N m s/rad.
    """

    def __init__(
        self,
        num_envs: int,
        control_period: float,
        physics_timestep: float,
        threads: int,
        gains: tuple[tuple[float, ...], tuple[float, ...]] = (go2.PD_GAIN_P, go2.PD_GAIN_D),
    ):
        self.num_envs = num_envs
        self.device = torch.device("cpu")
        self.control_period = control_period
        self.model = go2.load_model(physics_timestep)
        # MuJoCo would silently reset a simulation that diverges; it must stay visible instead.
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._substeps = round(control_period / physics_timestep)
        self._kp, self._kd = (np.array(g) for g in gains)
        self._batch = Batch(self.model, nsim=num_envs, nthread=threads)
        self._rows = {name: self._batch.bind(name) for name in _STATE_FIELDS}
        self._sensordata = self._batch.bind("sensordata")
        # Sensor values live in a copy of our own, so that a loaded checkpoint can restore them.
        self._forces = np.zeros((num_envs, self.model.nsensordata), dtype=np.float32)
        self._fields = _DynamicsFields(self._batch, self.model)
        self.set_dynamics(torch.arange(num_envs), Dynamics.nominal(num_envs, 0.8, self.device))
        self._batch.reset(keyframe=self.model.key("stand").id)

    @property
    def state(self) -> RobotState:
        qpos = torch.from_numpy(self._rows["qpos"].astype(np.float32))
        qvel = torch.from_numpy(self._rows["qvel"].astype(np.float32))
        # The sensors give the force of the first geom on the second; the reaction acts on the robot.
        force = -torch.from_numpy(self._forces.copy()).unflatten(1, (-1, 3))
        return RobotState(
            base_position=qpos[:, 0:3],
            base_quaternion=qpos[:, 3:7],
            base_linear_velocity=qvel[:, 0:3],
            base_angular_velocity=qvel[:, 3:6],
            joint_position=qpos[:, 7:],
            joint_velocity=qvel[:, 6:],
            foot_force=force[:, : go2.NUM_LEGS],
            body_force=force[:, go2.NUM_LEGS :],
        )

    def step(self, joint_target: Tensor) -> None:
        self._rows["ctrl"][:] = joint_target.numpy(force=True)
        self._batch.step(nstep=self._substeps)
        self._forces[:] = self._sensordata

    def reset(self, env_ids: Tensor, initial: InitialState) -> None:
        ids = env_ids.numpy()
        self._batch.reset(ids, stage=mujoco.mjtStage.mjSTAGE_NONE)
        position = (initial.base_position, initial.base_quaternion, initial.joint_position)
        velocity = (initial.base_linear_velocity, initial.base_angular_velocity, initial.joint_velocity)
        self._rows["qpos"][ids] = torch.cat(position, dim=1).numpy(force=True)
        self._rows["qvel"][ids] = torch.cat(velocity, dim=1).numpy(force=True)
        self._rows["ctrl"][ids] = initial.joint_position.numpy(force=True)
        self._batch.forward(ids)
        self._forces[ids] = self._sensordata[ids]

    def set_dynamics(self, env_ids: Tensor, dynamics: Dynamics) -> None:
        ids = env_ids.numpy()
        self._fields.write(ids, dynamics, self._kp, self._kd)
        self._batch.set_const(ids)

    def push(self, velocity_change: Tensor) -> None:
        self._rows["qvel"][:, 0:3] += velocity_change.numpy(force=True)

    def diverged(self) -> Tensor:
        finite = np.isfinite(self._rows["qpos"]).all(axis=1) & np.isfinite(self._rows["qvel"]).all(axis=1)
        return torch.from_numpy(~finite)

    def state_dict(self) -> dict[str, Any]:
        state = {name: torch.from_numpy(rows.copy()) for name, rows in self._rows.items()}
        state["forces"] = torch.from_numpy(self._forces.copy())
        return state

    def load_state_dict(self, state: dict[str, Any]) -> None:
        for name, rows in self._rows.items():
            rows[:] = state[name].numpy()
        self._forces[:] = state["forces"].numpy()

    def close(self) -> None:
        """Nothing to release: the thread pool ends with the batch."""


class _DynamicsFields:
    """Per-simulation model fields behind the parameters of ``Dynamics``."""

    def __init__(self, batch: Batch, model: mujoco.MjModel):
        self._links = [model.body(name).id for name in LINK_NAMES]
        self._payload = model.body("payload").id
        self._feet = [model.geom(f"{leg}_foot").id for leg in go2.FOOT_NAMES]
        self._nominal_mass = model.body_mass[self._links].copy()
        self._nominal_inertia = model.body_inertia[self._links].copy()
        self._mass = batch.expand("body_mass")
        self._inertia = batch.expand("body_inertia")
        self._position = batch.expand("body_pos")
        self._friction = batch.expand("geom_friction")
        self._gain = batch.expand("actuator_gainprm")
        self._bias = batch.expand("actuator_biasprm")

    def write(self, ids: np.ndarray, dynamics: Dynamics, kp: np.ndarray, kd: np.ndarray) -> None:
        value = {name: tensor.numpy(force=True) for name, tensor in dynamics.tensors().items()}
        rows = ids[:, None]
        self._mass[rows, self._links] = self._nominal_mass * value["link_mass_scale"]
        self._inertia[rows, self._links] = self._nominal_inertia * value["link_mass_scale"][:, :, None]
        # The payload is a point; MuJoCo wants a positive inertia where there is mass (a 5 cm ball's).
        self._mass[ids, self._payload] = value["payload_mass"]
        self._inertia[ids, self._payload] = (0.4 * 0.05**2 * value["payload_mass"])[:, None]
        self._position[ids, self._payload] = value["payload_position"]
        self._friction[rows, self._feet, 0] = value["friction"][:, None]
        stiffness = kp * value["kp_scale"] * value["motor_strength"]
        self._gain[ids, :, 0] = stiffness
        self._bias[ids, :, 1] = -stiffness
        self._bias[ids, :, 2] = -kd * value["kd_scale"] * value["motor_strength"]
