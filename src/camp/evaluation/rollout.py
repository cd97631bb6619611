"""Rolling a policy out as planned, all robots at once."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from camp.build import build_env
from camp.config.schema import Config
from camp.envs.config import EXTERNAL
from camp.envs.measurement import measure, sliding_speed
from camp.envs.observations import noise_width
from camp.evaluation.physics import MotorLaw
from camp.evaluation.plan import Plan
from camp.motion.clips.clip import Clip

Policy = Callable[[Tensor], Tensor]  # observation (N, O) -> action (N, 12)
Floats = NDArray[np.floating]


@dataclass
class Recording:
    """What R robots did over T control steps of ``period_s`` s.

    From its first fall on a robot counts as lying still: no speed, no contacts, no torques, its last pose.
    """

    period_s: float
    skill: NDArray[np.integer]  # (R, T) label commanded
    command: Floats  # (R, T, 3) vx, vy in m/s, yaw rate in rad/s
    velocity: Floats  # (R, T, 3) the same, reached at the step's end
    contact: NDArray[np.bool_]  # (R, T, 4) at its end
    joint_target: Floats  # (R, T, 12) rad, held during the step
    joint_position: Floats  # (R, T, 12) rad, at its end
    joint_velocity: Floats  # (R, T, 12) rad/s, at its end
    torque: Floats  # (R, T, 2, 12) N m, when the target is set and at the step's end
    power: Floats  # (R, T) W, sum over the joints of |torque x velocity|, mean of these two moments
    foot_speed: Floats  # (R, T, 4) m/s over the ground, at the step's end
    amp_state: Floats  # (R, T, 43) at the step's end
    qpos: Floats  # (R, T, 19) at the step's end, for pictures
    steps_upright: NDArray[np.integer]  # (R,) T where it never fell

    def __len__(self) -> int:
        return len(self.steps_upright)

    @property
    def fallen(self) -> NDArray[np.bool_]:
        """(R,) robots that fell."""
        return self.steps_upright < self.contact.shape[1]

    def take(self, rows: slice | NDArray) -> Recording:
        """The robots ``rows``."""
        return Recording(self.period_s, **{name: value[rows] for name, value in self._arrays().items()})

    def since(self, step: int) -> Recording:
        """All robots from a step on; ``steps_upright`` still counts from the start."""
        later = {name: value[:, step:] if value.ndim > 1 else value for name, value in self._arrays().items()}
        return Recording(self.period_s, **later)

    def _arrays(self) -> dict[str, NDArray]:
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "period_s"}


# What a fallen robot has none of, and what it keeps: what the simulation shows then is the restarted robot's.
_GONE = ("velocity", "contact", "joint_velocity", "torque", "power", "foot_speed")
_KEPT = ("joint_target", "joint_position", "amp_state", "qpos")


def evaluation_setting(config: Config, steps: int) -> Config:
    """The run's configuration on the CPU, with standing starts, without randomness of its own, commanded from outside
    in episodes that outlast ``steps``."""
    setting = copy.deepcopy(config)
    setting.sim = config.sim.on_cpu()
    env = setting.env
    env.command.source = EXTERNAL
    env.episode_s = (steps + 1) * env.control_period_s
    env.episode_growth.initial_s = env.episode_growth.by_skill_from_s = env.hardening.initial = None
    env.noise.enabled = env.randomization.enabled = env.push.enabled = False
    env.initialization.reference_fraction = 0.0
    env.initialization.joint_position_scale = [1.0, 1.0]
    return setting


def roll_out(policy: Policy, config: Config, plan: Plan, clips: list[Clip], seed: int) -> Recording:
    """Run the deterministic ``policy`` with the robots of ``plan``.

    config: that of the run; clips: its expert clips; seed: of the sensor noise and the pushes' directions.
    """
    num, steps = plan.skill.shape
    env = build_env(evaluation_setting(config, steps), clips, num_envs=num)
    motors = MotorLaw.of(env.robot, plan.dynamics)
    trouble = _Trouble(plan, noise_width(env.actor_entries, config.env.noise), config.env.control_period_s, seed)
    kept: dict[str, list[Tensor]] = {}
    steps_upright = torch.full((num,), steps)
    try:
        env.reset(seed=seed, options={"stagger": False, "dynamics": plan.dynamics})
        before = env.sim.state
        for step in range(steps):
            skill = plan.skill[:, step]
            if step == 0 or not torch.equal(skill, plan.skill[:, step - 1]):
                env.set_command(plan.command, skill)
            with torch.no_grad():
                action = policy(trouble.observed(env.observation))
            trouble.push(step, env.sim.push)
            result = env.advance(action)
            after = env.sim.state
            steps_upright = torch.where(result.terminated, steps_upright.clamp(max=step), steps_upright)
            target = env.default_pose + config.robot.action_scale * action
            joints = ((state.joint_position, state.joint_velocity) for state in (before, after))
            torques = [(motors.torque(target, *joint), joint[1]) for joint in joints]
            values = {
                "skill": skill,
                "command": plan.command,
                "velocity": result.velocity,
                "contact": result.foot_contact,
                "joint_target": target,
                "joint_position": after.joint_position,
                "joint_velocity": after.joint_velocity,
                "torque": torch.stack([torque for torque, _ in torques], dim=1),
                "power": sum((torque * speed).abs().sum(dim=1) for torque, speed in torques) / len(torques),
                "foot_speed": sliding_speed(env.robot, measure(env.robot, after)),
                "amp_state": result.transition[:, -1],
                "qpos": after.qpos(),
            }
            for name, value in values.items():
                kept.setdefault(name, []).append(value)
            before = after
    finally:
        env.close()
    arrays = {name: torch.stack(values, dim=1).numpy() for name, values in kept.items()}
    for robot, upright in enumerate(steps_upright.tolist()):
        for name in _GONE:
            arrays[name][robot, upright:] = 0
        for name in _KEPT:
            arrays[name][robot, upright:] = arrays[name][robot, max(upright - 1, 0)]
    return Recording(config.env.control_period_s, steps_upright=steps_upright.numpy(), **arrays)


class _Trouble:
    """Sensor noise and pushes, robot by robot."""

    def __init__(self, plan: Plan, width: Tensor, period_s: float, seed: int):
        self._noise = plan.noise[:, None] * width  # (R, O) half-width
        self._push = plan.push_m_s
        self._steps = max(1, round(plan.push_period_s / period_s))
        self._generator = torch.Generator().manual_seed(seed)

    def observed(self, observation: Tensor) -> Tensor:
        """The observation as the policy gets it."""
        if not self._noise.any():
            return observation
        draw = torch.rand(observation.shape, generator=self._generator) * 2.0 - 1.0
        return observation + self._noise * draw

    def push(self, step: int, apply: Callable[[Tensor], None]) -> None:
        """Push the robots that have it coming, (R, 3) m/s."""
        if step == 0 or step % self._steps or not self._push.any():
            return
        angle = 2.0 * torch.pi * torch.rand(len(self._push), generator=self._generator)
        apply(torch.stack([torch.cos(angle), torch.sin(angle), torch.zeros_like(angle)], 1) * self._push[:, None])
