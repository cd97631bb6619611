"""Rolling a policy out over every skill and command, and through the switching sequence (one skill of each gait)."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from camp.build import build_env
from camp.config import Config
from camp.evaluation.config import EvaluationConfig
from camp.motion.clips import Clip

Policy = Callable[[Tensor], Tensor]  # observation (N, O) -> action (N, 12)


@dataclass
class Recording:
    """What K skills x G commands and the switching sequence did over T control steps; the switch comes last.

    R = K G + 1 robots. From its first fall on a robot counts as lying still: velocity 0, no contacts, last pose.
    """

    period_s: float
    skill: NDArray[np.integer]  # (R, T) label commanded
    command: NDArray[np.floating]  # (R, T, 3) vx, vy in m/s, yaw rate in rad/s
    velocity: NDArray[np.floating]  # (R, T, 3) the same, reached
    contact: NDArray[np.bool_]  # (R, T, 4)
    joint_target: NDArray[np.floating]  # (R, T, 12) rad, held during the step
    joint_position: NDArray[np.floating]  # (R, T, 12) rad, at its end
    qpos: NDArray[np.floating]  # (R, T, 19) for pictures
    steps_upright: NDArray[np.integer]  # (R,) T where it never fell

    @property
    def fallen(self) -> NDArray[np.bool_]:
        """(R,) robots that fell."""
        return self.steps_upright < self.contact.shape[1]


def evaluation_setting(config: Config, evaluation: EvaluationConfig) -> Config:
    """The run's configuration on the CPU with the nominal robot, no noise, no pushes, standing starts, no clock."""
    setting = copy.deepcopy(config)
    setting.sim = config.sim.on_cpu()
    endless = 10.0 * evaluation.duration_s
    env = setting.env
    env.episode_s = env.command.period_s = env.command.skill_period_s = env.push.period_s = endless
    env.noise.enabled = env.randomization.enabled = env.push.enabled = False
    env.initialization.reference_share = 0.0
    env.initialization.joint_position_scale = [1.0, 1.0]
    return setting


def roll_out(policy: Policy, config: Config, evaluation: EvaluationConfig, clips: list[Clip]) -> Recording:
    """Run the deterministic ``policy`` in all situations at once."""
    skills, commands = config.motion.skill_set(), torch.tensor(evaluation.commands, dtype=torch.float32)
    num_skills = len(skills)
    grid_skill = torch.arange(num_skills).repeat_interleave(len(commands))
    command = torch.cat([commands.repeat(num_skills, 1), torch.tensor([evaluation.switch_command])])
    steps = round(evaluation.duration_s / config.env.control_period_s)
    one_per_gait = torch.tensor([next(k for k, s in enumerate(skills) if s.gait == g) for g in config.motion.skills])
    switch_skill = one_per_gait[torch.arange(steps) * len(one_per_gait) // steps]
    env = build_env(evaluation_setting(config, evaluation), clips, num_envs=len(command))
    kept: dict[str, list[Tensor]] = {name: [] for name in _RECORDED}
    steps_upright = torch.full((len(command),), steps)
    try:
        env.reset(seed=config.seed, options={"stagger": False})
        for step in range(steps):
            skill = torch.cat([grid_skill, switch_skill[step : step + 1]])
            observation = env.set_command(command, skill)
            with torch.no_grad():
                action = policy(observation)
            result = env.advance(action)
            state = env.sim.state
            steps_upright = torch.where(result.terminated, steps_upright.clamp(max=step), steps_upright)
            target = env.default_pose + config.robot.action_scale * action
            values = (
                skill,
                command,
                result.velocity,
                result.foot_contact,
                target,
                state.joint_position,
                state.qpos(),
            )
            for name, value in zip(_RECORDED, values, strict=True):
                kept[name].append(value)
    finally:
        env.close()
    arrays = {name: torch.stack(values, dim=1).numpy() for name, values in kept.items()}
    for robot, upright in enumerate(steps_upright.tolist()):
        arrays["velocity"][robot, upright:] = 0.0
        arrays["contact"][robot, upright:] = False
        for name in ("joint_target", "joint_position", "qpos"):  # what follows is the restarted robot's
            arrays[name][robot, upright:] = arrays[name][robot, max(upright - 1, 0)]
    return Recording(config.env.control_period_s, steps_upright=steps_upright.numpy(), **arrays)


_RECORDED = ("skill", "command", "velocity", "contact", "joint_target", "joint_position", "qpos")
