"""One robot in a MuJoCo simulation: its joints' places, its gains, its stand, and whether it has diverged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from camp.robots.quadruped import FOOT_NAMES

_DIVERGED = (  # MuJoCo starts anew after these, with no more than a warning
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


@dataclass(frozen=True)
class Joints:
    """Where named joints stand in MuJoCo's arrays, each (J,): in qpos, in qvel, and among the actuators."""

    position: NDArray[np.integer]
    velocity: NDArray[np.integer]
    motor: NDArray[np.integer]

    @classmethod
    def of(cls, model: mujoco.MjModel, names: Sequence[str]) -> Joints:
        """In the order of the names."""
        joints = [model.joint(name) for name in names]
        return cls(
            position=np.array([joint.qposadr[0] for joint in joints]),
            velocity=np.array([joint.dofadr[0] for joint in joints]),
            motor=np.array([model.actuator(name).id for name in names]),
        )

    def set_gains(self, model: mujoco.MjModel, kp: ArrayLike, kd: ArrayLike) -> None:
        """Gains (J,) of the PD law, N m/rad and N m s/rad.

        A position actuator's force is kp (target - q) - kd q', clipped at the torque limit in the model.
        """
        model.actuator_gainprm[self.motor, 0] = kp
        model.actuator_biasprm[self.motor, 1] = -np.asarray(kp)
        model.actuator_biasprm[self.motor, 2] = -np.asarray(kd)


def put_on_ground(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Lower or raise the robot as it stands until its lowest foot just touches the ground."""
    data.qpos[2] -= lowest_foot(model, data)
    mujoco.mj_forward(model, data)


def lowest_foot(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Height of the lowest foot's underside above the ground, m; brings the kinematics of ``data`` up to date."""
    mujoco.mj_kinematics(model, data)
    feet = [model.geom(f"{leg}_foot").id for leg in FOOT_NAMES]
    return float((data.geom_xpos[feet, 2] - model.geom_size[feet, 0]).min())


def has_diverged(data: mujoco.MjData) -> bool:
    """Whether the state was not finite at any time."""
    return any(data.warning[kind].number for kind in _DIVERGED)
