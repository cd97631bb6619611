"""Mean task reward of the expert's steady clips: ``python -m analysis.task_reward``."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import torch
from rich.console import Console
from rich.table import Table
from torch import Tensor

from camp.build import build_robot, motion_folder
from camp.config.compose import compose_config
from camp.envs.config import RewardConfig
from camp.envs.rewards import angular_velocity_reward, averaged, linear_velocity_reward, mix_rewards
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clips

TIME_CONSTANTS = (0.0, 0.5, 1.0)  # s, of the velocity's average


def weighted_reward(command: Tensor, velocity: Tensor, config: RewardConfig) -> Tensor:
    """(T,) Table II's task reward for velocities (T, 3): vx, vy in m/s and yaw rate in rad/s."""
    linear, angular = config.terms["linear_velocity"], config.terms["angular_velocity"]
    rewards = {
        "linear_velocity": linear_velocity_reward(command, velocity, linear["width"]),
        "angular_velocity": angular_velocity_reward(command, velocity, angular["width"]),
    }
    return mix_rewards(rewards, {"linear_velocity": linear["weight"], "angular_velocity": angular["weight"]})


def reward_of(clip: Clip, config: RewardConfig, time_constant: float) -> float:
    """Mean over a steady clip's rows, the average beginning with the command."""
    command = torch.from_numpy(np.broadcast_to(clip.command, (len(clip), 3)).copy())
    velocity = torch.from_numpy(np.c_[clip.base_linear_velocity[:, :2], clip.base_angular_velocity[:, 2]])
    averages, average = [], command[0]
    for row in velocity:
        average = averaged(average, row, clip.dt, time_constant)
        averages.append(average)
    return float(weighted_reward(command, torch.stack(averages), config).mean())


def reward_of_standing(clip: Clip, config: RewardConfig) -> float:
    """What a robot gets that stands still under the clip's command."""
    return float(weighted_reward(torch.from_numpy(clip.command)[None], torch.zeros(1, 3), config))


def main() -> None:
    config = compose_config([])
    rows = defaultdict(list)
    for clip in load_clips(build_robot(config.robot), motion_folder(config), tuple(GAIT_PHASES), splits=("steady",)):
        reward = config.env.reward
        values = [reward_of(clip, reward, constant) for constant in TIME_CONSTANTS]
        rows[clip.gait, clip.frequency_hz].append([*values, reward_of_standing(clip, reward)])
    table = Table(title="task reward of the expert, mean over its steady clips")
    for heading in ("gait", "Hz", *(f"averaged over {constant:g} s" for constant in TIME_CONSTANTS), "standing still"):
        table.add_column(heading, justify="left" if heading == "gait" else "right")
    for (gait, frequency), values in rows.items():
        table.add_row(gait, f"{frequency:g}", *(f"{value:.2f}" for value in np.mean(values, axis=0)))
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
