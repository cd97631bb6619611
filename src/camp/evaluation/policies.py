"""Where policies come from: run folders, exported ONNX files, and anybody's ONNX with a contract."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from camp.common.errors import CampError
from camp.common.onnx_session import ERRORS, open_session
from camp.config.schema import Config
from camp.evaluation.contract import TERM_SIZES, CommandRange, Contract, Output, Term
from camp.robots.quadruped import JOINT_NAMES, NUM_JOINTS, NUM_LEGS
from camp.robots.registry import find_robot


def contract_of_run(name: str, config: Config) -> Contract:
    """The contract of a policy that camp trained; its network answers with actions.

    Raises CampError where it observes what no contract names.
    """
    pose = list(find_robot(config.robot.name).default_joint_position)
    skills, entries = config.motion.skill_set(), list(config.env.observation.policy)
    unknown = [name for name in entries if name not in (*TERM_SIZES, "skill")]
    if unknown:
        raise CampError(
            f"env.observation.policy: the judge's contract has no term {unknown[0]!r}; choose from "
            f"{', '.join((*TERM_SIZES, 'skill'))}"
        )
    return _contract(
        name,
        [skill.name for skill in skills],
        config.env.observe_skill,
        _range(config.env.command.vx_m_s, config.env.command.vy_m_s, config.env.command.yaw_rate_rad_s),
        robot=config.robot.name,
        control_period_s=config.env.control_period_s,
        joint_names=list(JOINT_NAMES),
        default_pose=pose,
        kp=list(config.robot.kp) * NUM_LEGS,
        kd=list(config.robot.kd) * NUM_LEGS,
        output=Output(scale=config.robot.action_scale, offset=pose),
        observation=[Term(name) for name in entries],
        history=config.env.observation.history,
    )


def contract_of_metadata(name: str, metadata: Mapping[str, Any]) -> Contract:
    """The contract of what `camp.export` writes, whose network answers with joint targets."""
    pose, terms = list(metadata["default_pose"]), [Term(entry["name"]) for entry in metadata["observation"]]
    last_action = Term("last_action", scale=1.0 / metadata["action_scale"], offset=pose)
    allowed = metadata["command_range"]
    return _contract(
        name,
        metadata["skills"],
        metadata["observe_skill"],
        _range(allowed["vx_m_s"], allowed["vy_m_s"], allowed["yaw_rate_rad_s"]),
        robot=metadata["robot"],
        control_period_s=metadata["control_period"],
        joint_names=metadata["joint_names"],
        default_pose=pose,
        kp=metadata["kp"],
        kd=metadata["kd"],
        output=Output(),
        observation=[last_action if term.term == "last_action" else term for term in terms],
        history=metadata["history"],
    )


class OnnxAnswer:
    """An ONNX network with one input (N, O) and one output (N, 12), or with N fixed at 1."""

    def __init__(self, path: Path):
        """Raises CampError where the file or onnxruntime is missing, or the file holds no such network."""
        self._session = open_session(path, "not found", ERRORS)
        inputs, outputs = self._session.get_inputs(), self._session.get_outputs()
        if len(inputs) != 1 or len(inputs[0].shape) != 2 or inputs[0].type != "tensor(float)":
            found = ", ".join(f"{one.name} {one.shape} {one.type}" for one in inputs)
            raise CampError(f"policy {path}: takes {found}; export it with one input (N, O) of float32")
        self.path, self._input, self._output = path, inputs[0], outputs[0].name
        self.metadata = self._session.get_modelmeta().custom_metadata_map

    def check(self, contract: Contract) -> None:
        """Raise CampError where the network does not fit its contract."""
        width = self._input.shape[1]
        if isinstance(width, int) and width != contract.observation_size:
            raise CampError(
                f"policy {self.path}: takes {width} numbers, its contract's observation has "
                f"{contract.observation_size}; check the terms, the skills' encodings and the history"
            )
        try:
            answer = self(torch.zeros(2, contract.observation_size))
        except Exception as error:  # whatever onnxruntime raises for shapes that do not fit
            raise CampError(f"policy {self.path}: does not run ({str(error).splitlines()[0]})") from error
        if tuple(answer.shape) != (2, NUM_JOINTS):
            raise CampError(f"policy {self.path}: answers {tuple(answer.shape)} to 2 robots, (2, 12) is needed")
        if not answer.isfinite().all():
            raise CampError(f"policy {self.path}: its answer to zeros is not finite; export it again")

    def __call__(self, observation: Tensor) -> Tensor:
        """(N, O) -> (N, 12)."""
        rows = observation.numpy().astype(np.float32)
        if self._input.shape[0] == 1:
            parts = [self._session.run([self._output], {self._input.name: row[None]})[0] for row in rows]
            return torch.from_numpy(np.concatenate([np.asarray(part) for part in parts]))
        return torch.from_numpy(np.array(self._session.run([self._output], {self._input.name: rows})[0]))


def _contract(name: str, skills: list[str], observed: bool, allowed: CommandRange, **rest: Any) -> Contract:
    encodings = {skill: [float(observed and skill == other) for other in skills] for skill in skills}
    return Contract(contract=1, name=name, skills=encodings, command_range=allowed, **rest)


def _range(vx: list[float], vy: list[float], yaw_rate: list[float]) -> CommandRange:
    return CommandRange((vx[0], vx[1]), (vy[0], vy[1]), (yaw_rate[0], yaw_rate[1]))
