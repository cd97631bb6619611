"""A run's policy as an ONNX graph with its metadata beside it."""

from __future__ import annotations

import json
import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from camp import __version__
from camp.algo.models import GaussianActor
from camp.build import build_robot, load_run
from camp.common.errors import ConfigError
from camp.common.files import whole_pair
from camp.config.schema import Config
from camp.deployment.loop import Policy
from camp.deployment.onnx_graph import OPSET, ExportError, largest_difference, policy_graph, require_packages
from camp.envs.observations import entries_of
from camp.gaits.skills import names
from camp.robots.quadruped import JOINT_NAMES
from camp.robots.robot import Robot
from camp.runs.folder import METADATA, MODEL

TOLERANCE = 1e-5  # rad, between the exported policy and torch's
CHECKED_OBSERVATIONS = 1000


@dataclass(frozen=True)
class Exported:
    """What was written. difference: largest one to torch's answers on random observations, rad."""

    model: Path
    metadata: Path
    difference: float


class JointTargets(nn.Module):
    """The deterministic policy in the robot's units: raw observation (N, O) -> joint target (N, 12) in rad."""

    default_pose: Tensor

    def __init__(self, robot: Robot, actor: GaussianActor, action_scale: float) -> None:
        """action_scale: rad per unit of the actor's output."""
        super().__init__()
        self.actor, self.action_scale = actor, action_scale
        self.register_buffer("default_pose", torch.tensor(robot.default_joint_position))

    def forward(self, observation: Tensor) -> Tensor:
        return self.default_pose + self.action_scale * self.actor(observation)


def metadata(config: Config) -> dict[str, Any]:
    """All that a controller needs besides the network, as plain values; docs/deployment.md tells what each means."""
    robot, skills = build_robot(config.robot), config.motion.skill_set()
    return {
        "robot": robot.name,
        "joint_names": list(JOINT_NAMES),
        "default_pose": list(robot.default_joint_position),
        "kp": list(robot.pd_gain_p),
        "kd": list(robot.pd_gain_d),
        "action_scale": config.robot.action_scale,
        "control_period": config.env.control_period_s,
        "skills": list(names(skills)),
        "command_range": {
            "vx_m_s": list(config.env.command.vx_m_s),
            "vy_m_s": list(config.env.command.vy_m_s),
            "yaw_rate_rad_s": list(config.env.command.yaw_rate_rad_s),
        },
        "observation": [
            {"name": entry.name, "size": entry.size, "unit": entry.unit}
            for entry in entries_of(config.env.observation.policy, len(skills))
        ],
        "history": config.env.observation.history,
        "observe_skill": config.env.observe_skill,
        "camp_version": __version__,
        "opset": OPSET,
    }


def export_policy(run: Path, output: Path) -> Exported:
    """Write the latest policy of a run folder into the folder ``output``. Raises CampError."""
    require_packages()
    loaded = load_run(run)
    scale, described = loaded.config.robot.action_scale, metadata(loaded.config)
    targets = JointTargets(build_robot(loaded.config.robot), loaded.actor, scale)
    model = policy_graph(loaded.actor, targets.default_pose, scale, described)
    difference = largest_difference(model, targets, _plausible_observations(loaded.actor))
    if not math.isfinite(difference):
        raise ExportError(f"policy of {run}: its joint targets are not finite; export a run whose training held")
    if difference > TOLERANCE:
        raise ExportError(
            f"policy of {run}: onnxruntime's answers differ from torch's by {difference:.1e} rad; use the versions of "
            "onnx and onnxruntime in constraints.txt"
        )
    paths = output / MODEL, output / METADATA
    try:
        with whole_pair(*paths) as (graph, beside):
            graph.write(model.SerializeToString())
            beside.write((json.dumps(described, indent=2) + "\n").encode())
    except OSError as error:
        raise ConfigError(f"output {output}: {error.strerror or error}; choose a folder that can be written") from error
    return Exported(*paths, difference)


def policy_of_run(run: Path) -> Policy:
    """The latest policy of a run folder as the control loop knows it: exported, nothing is left behind. Raises
    CampError."""
    with tempfile.TemporaryDirectory() as folder:
        return Policy(export_policy(run, Path(folder)).model)


def _plausible_observations(actor: GaussianActor) -> Tensor:
    """Random ones, spread as those that the policy was trained on."""
    spread = torch.randn(CHECKED_OBSERVATIONS, len(actor.normalizer.mean), generator=torch.Generator().manual_seed(0))
    return (actor.normalizer.mean + actor.normalizer.std * spread).to(torch.float32)
