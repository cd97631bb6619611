"""From simulation to clip: reads one row per control step out of the learner's simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from camp.motion.clips.clip import Clip
from camp.motion.dataset.requests import ClipRequest
from camp.robots.quadruped import CONTACT_FORCE, FOOT_NAMES


@dataclass(frozen=True)
class Answer:
    """What happened in the control step that follows a recorded state; all (12,) but the command (3,)."""

    joint_target: np.ndarray
    joint_target_applied: np.ndarray
    joint_torque: np.ndarray
    command: np.ndarray


class Recorder:
    """Collects rows; reads states on a copy, so that recording does not touch the simulation."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        self._copy = mujoco.MjData(model)
        self._base = model.body("base").id
        self._foot_body = [model.body(f"{leg}_foot").id for leg in FOOT_NAMES]
        self._rows: list[dict[str, np.ndarray]] = []

    def __len__(self) -> int:
        return len(self._rows)

    def add(self, state: np.ndarray, previous_target: np.ndarray, answer: Answer) -> None:
        """Record a state (37,), qpos then qvel, that was reached under `previous_target` (12,)."""
        model, data = self._model, self._copy
        data.qpos[:], data.qvel[:] = state[: model.nq], state[model.nq :]
        data.ctrl[:] = previous_target
        mujoco.mj_forward(model, data)
        to_base = data.xmat[self._base].reshape(3, 3).T
        jacobian = np.zeros((4, 3, model.nv))
        for leg, body in enumerate(self._foot_body):
            mujoco.mj_jacBody(model, data, jacobian[leg], None, body)
        force = np.array([data.sensor(f"{leg}_contact").data for leg in FOOT_NAMES])
        self._rows.append(
            {
                "command": answer.command,
                "base_position": data.qpos[:3].copy(),
                "base_quaternion": data.qpos[3:7].copy(),
                "joint_position": data.qpos[7:].copy(),
                "joint_velocity": data.qvel[6:].copy(),
                "base_linear_velocity": to_base @ data.qvel[:3],
                "base_angular_velocity": data.qvel[3:6].copy(),
                "foot_position": (data.xpos[self._foot_body] - data.xpos[self._base]) @ to_base.T,
                "foot_velocity": (jacobian[:, :, 6:] @ data.qvel[6:]) @ to_base.T,
                "foot_contact": np.linalg.norm(force, axis=1) > CONTACT_FORCE,
                "joint_target": answer.joint_target,
                "joint_target_applied": answer.joint_target_applied,
                "joint_torque": answer.joint_torque,
            }
        )

    def clip(self, request: ClipRequest, period: float, switch_step: int = 0) -> Clip:
        """All rows as a clip that begins at x = y = 0; where one command is held, the last one alone is kept."""
        rows = {name: np.array([row[name] for row in self._rows]) for name in self._rows[0]}
        rows["base_position"][:, :2] -= rows["base_position"][0, :2].copy()
        if request.holds_command:
            rows["command"] = rows["command"][-1]
        single: dict[str, Any] = {
            name: row if row.dtype == bool else row.astype(np.float32) for name, row in rows.items()
        }
        return Clip(
            dt=period,
            gait=request.gait,
            frequency_hz=request.frequency_hz,
            split=request.split,
            seed=request.seed,
            previous_gait=request.previous_gait,
            switch_step=switch_step,
            **single,
        )
