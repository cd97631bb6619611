"""The fields of the MuJoCo model behind the physical parameters of ``Dynamics``, for any backend."""

from __future__ import annotations

import mujoco
import torch
from torch import Tensor

from camp.robots.quadruped import FOOT_NAMES
from camp.robots.robot import Robot
from camp.sim.base import LINK_NAMES, Dynamics

# Fields that differ from robot to robot; what MuJoCo derives from them (``set_const``) is the backend's part.
FIELD_NAMES: tuple[str, ...] = (
    "body_mass",
    "body_inertia",
    "body_pos",
    "geom_friction",
    "actuator_gainprm",
    "actuator_biasprm",
)
_PAYLOAD_RADIUS = 0.05  # m; the payload is a point, but MuJoCo wants a positive inertia where there is mass


def nominal_friction(model: mujoco.MjModel) -> float:
    """Foot-ground coefficient of the robot as published."""
    return float(model.geom(f"{FOOT_NAMES[0]}_foot").friction[0])


class ModelFields:
    """Maps ``Dynamics`` to the model's fields.

    Args:
        model: the nominal robot's.
        robot: the nominal robot, for its PD gains.
        device: of the dynamics and of the fields.
    """

    def __init__(self, model: mujoco.MjModel, robot: Robot, device: torch.device):
        def rows(ids: list[int]) -> Tensor:
            return torch.tensor(ids, device=device)

        self._nominal = {name: torch.tensor(getattr(model, name), device=device) for name in FIELD_NAMES}
        self._links = rows([model.body(name).id for name in LINK_NAMES])
        self._feet = rows([model.geom(f"{leg}_foot").id for leg in FOOT_NAMES])
        self._payload = model.body("payload").id
        gains = (robot.pd_gain_p, robot.pd_gain_d)
        self._kp, self._kd = (torch.tensor(gain, dtype=torch.float64, device=device) for gain in gains)

    def of(self, dynamics: Dynamics) -> dict[str, Tensor]:
        """Name to values (n, ...), float64, for n robots."""
        num = len(dynamics.payload_mass)
        field = {name: value.expand(num, *value.shape).clone() for name, value in self._nominal.items()}
        scale = dynamics.link_mass_scale
        field["body_mass"][:, self._links] *= scale
        field["body_inertia"][:, self._links] *= scale[:, :, None]
        field["body_mass"][:, self._payload] = dynamics.payload_mass.double()
        field["body_inertia"][:, self._payload] = (0.4 * _PAYLOAD_RADIUS**2 * dynamics.payload_mass.double())[:, None]
        field["body_pos"][:, self._payload] = dynamics.payload_position.double()
        field["geom_friction"][:, self._feet, 0] = dynamics.friction.double()[:, None]
        stiffness = self._kp * dynamics.kp_scale * dynamics.motor_strength
        field["actuator_gainprm"][:, :, 0] = stiffness
        field["actuator_biasprm"][:, :, 1] = -stiffness
        field["actuator_biasprm"][:, :, 2] = -self._kd * dynamics.kd_scale * dynamics.motor_strength
        return field
