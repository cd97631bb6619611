"""A run's policy for Unitree's C++ controllers (unitree_rl_mjlab, unitree_rl_lab): a folder for each skill.

These controllers know velocity commands and no skills, so each skill becomes a policy of its own, which observes that
skill always. A folder holds `exported/policy.onnx` and `params/deploy.yaml`; the latter says what is observed in which
order, how an action becomes joint targets, and which motor each joint is.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch
import yaml

from camp.build import build_robot, load_run
from camp.common.errors import ConfigError
from camp.common.files import whole_pair
from camp.config.schema import Config
from camp.deployment.export import metadata
from camp.deployment.metadata import ENTRY_SIZES
from camp.deployment.onnx_graph import ExportError, one_skill_graph
from camp.robots.motor_order import MOTOR_NAMES
from camp.robots.quadruped import JOINT_NAMES, NUM_JOINTS
from camp.runs.folder import MODEL

# Their names of our observation's entries; all with the same numbers, units and frames.
TERMS = {
    "base_angular_velocity": "base_ang_vel",
    "gravity": "projected_gravity",
    "command": "velocity_commands",
    "joint_position": "joint_pos_rel",
    "joint_velocity": "joint_vel_rel",
    "last_action": "last_action",
}


def export_for_unitree(run: Path, output: Path) -> list[Path]:
    """Write ``<output>/<skill>/`` for every skill; returns these folders.

    Raises ExportError for a policy that observes what the controllers do not know, ConfigError where ``output`` cannot
    be written.
    """
    loaded = load_run(run)
    parameters = yaml.safe_dump(deploy_parameters(loaded.config), default_flow_style=None, sort_keys=False, width=120)
    seen = torch.eye(len(loaded.skills)) * float(loaded.config.env.observe_skill)
    described = metadata(loaded.config)
    folders = []
    for skill, row in zip(loaded.skills, seen, strict=True):
        graph = one_skill_graph(loaded.actor, row, described | {"skill": skill})
        folder = output / skill
        try:
            for part in ("exported", "params"):
                (folder / part).mkdir(parents=True, exist_ok=True)
            with whole_pair(folder / "exported" / MODEL, folder / "params" / "deploy.yaml") as (model, beside):
                model.write(graph.SerializeToString())
                beside.write(parameters.encode())
        except OSError as error:
            raise ConfigError(
                f"output {folder}: {error.strerror or error}; choose a folder that can be written"
            ) from error
        folders.append(folder)
    return folders


def deploy_parameters(config: Config) -> dict[str, Any]:
    """The contents of deploy.yaml. Raises ExportError for a policy that observes something else."""
    entries = list(config.env.observation.policy)
    unknown = [name for name in entries[:-1] if name not in TERMS]
    if unknown or entries[-1] != "skill":
        raise ExportError(
            f"env.observation.policy = {', '.join(entries)}: Unitree's controllers observe {', '.join(TERMS)}, and the "
            "skill must come last to be left out; train with these"
        )
    if config.env.observation.history > 1:
        raise ExportError(
            f"env.observation.history = {config.env.observation.history}: Unitree's controllers put the control steps "
            "of each term side by side, which this policy does not; train with 1"
        )
    robot, command = build_robot(config.robot), config.env.command
    pose, scale = list(robot.default_joint_position), [config.robot.action_scale] * NUM_JOINTS
    return {
        "joint_ids_map": [MOTOR_NAMES.index(name) for name in JOINT_NAMES],
        "step_dt": config.env.control_period_s,
        "stiffness": list(robot.pd_gain_p),
        "damping": list(robot.pd_gain_d),
        "default_joint_pos": pose,
        "commands": {
            "base_velocity": {
                "ranges": {
                    "lin_vel_x": list(command.vx_m_s),
                    "lin_vel_y": list(command.vy_m_s),
                    "ang_vel_z": list(command.yaw_rate_rad_s),
                    "heading": None,
                }
            }
        },
        "actions": {
            "JointPositionAction": {
                "clip": None,
                "joint_names": [".*"],
                "scale": scale,
                "offset": pose,
                "joint_ids": None,
            }
        },
        "observations": {
            TERMS[name]: {
                "params": {"command_name": "base_velocity"} if name == "command" else {},
                "clip": None,
                "scale": [1.0] * ENTRY_SIZES[name],
                "history_length": 1,
            }
            for name in entries[:-1]
        },
    }
