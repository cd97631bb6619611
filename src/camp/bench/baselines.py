"""The programs that the benchmark compares: the simulator alone, camp's and Gymnasium's vector environments."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

import gymnasium as gym
import mujoco
import numpy as np
import torch
from gymnasium.vector import AsyncVectorEnv
from mujoco.batch import Batch
from torch import Tensor

from camp.build import build_simulator
from camp.config.schema import Config
from camp.envs.quadruped import QuadrupedEnv
from camp.robots.robot import Robot
from camp.single_env import Go2Env

STEPS = 40  # control steps per round
NOISE = 0.25  # rad, of the random targets

Rounds = dict[str, Callable[[], int]]  # name to a round that returns the control steps made


class PlainEnv(gym.Env):
    """The same model stepped by a plain MuJoCo loop, without rewards, commands or AMP states: the cheapest
    single environment there could be."""

    observation_space = gym.spaces.Box(-np.inf, np.inf, (37,), np.float32)
    action_space = gym.spaces.Box(-np.inf, np.inf, (12,), np.float32)

    def __init__(self, robot: Robot) -> None:
        self.robot, self.model = robot, robot.load_model()
        self.data = mujoco.MjData(self.model)

    def reset(self, *, seed: int | None = None, options: dict | None = None) -> tuple[np.ndarray, dict]:
        super().reset(seed=seed)
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key("stand").id)
        return self._observe(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        self.data.ctrl[:] = self.robot.default_joint_position + NOISE * action
        mujoco.mj_step(self.model, self.data, 4)
        return self._observe(), 0.0, bool(self.data.qpos[2] < self.robot.standing_height / 2), False, {}

    def _observe(self) -> np.ndarray:
        return np.concatenate([self.data.qpos, self.data.qvel]).astype(np.float32)


@contextmanager
def baselines(env: QuadrupedEnv, config: Config) -> Iterator[Rounds]:
    """The bare simulator first, then what is compared with it, all with the same random actions."""
    generator = torch.Generator().manual_seed(0)
    actions = torch.randn(STEPS, env.num_envs, 12, generator=generator).to(env.sim.device)

    def ours() -> int:
        for action in actions:
            env.step(action)
        return STEPS * env.num_envs

    if config.sim.backend == "gpu":
        yield {"mujoco_warp, bare": _bare_warp(env.robot, actions, config), "camp env.step": ours}
        return
    workers = os.cpu_count() or 1
    same = AsyncVectorEnv([partial(_single_environment, env.robot.name)] * workers)
    plain = AsyncVectorEnv([partial(PlainEnv, env.robot)] * workers)
    try:
        yield {
            "mujoco.batch, bare": _bare_batch(env.robot, actions, config),
            "camp env.step": ours,
            "AsyncVectorEnv of camp/Go2-v0": _gymnasium(same, actions, workers),
            "AsyncVectorEnv of a plain loop": _gymnasium(plain, actions, workers),
        }
    finally:
        same.close()
        plain.close()


def _bare_warp(robot: Robot, actions: Tensor, config: Config) -> Callable[[], int]:
    num = actions.shape[1]
    sim = build_simulator(config, num)
    targets = torch.tensor(robot.default_joint_position, device=sim.device) + NOISE * actions

    def run() -> int:
        for target in targets:
            sim.step(target)
        return STEPS * num

    return run


def _bare_batch(robot: Robot, actions: Tensor, config: Config) -> Callable[[], int]:
    num = actions.shape[1]
    batch = Batch(robot.load_model(config.sim.physics_timestep_s), nsim=num, nthread=config.sim.threads)
    substeps = round(config.env.control_period_s / config.sim.physics_timestep_s)
    batch.reset(keyframe=0)
    ctrl = batch.bind("ctrl")
    pose = torch.tensor(robot.default_joint_position)

    def run() -> int:
        for action in actions:
            ctrl[:] = (pose + NOISE * action).numpy()
            batch.step(nstep=substeps)
        return STEPS * num

    return run


def _gymnasium(vector: AsyncVectorEnv, actions: Tensor, workers: int) -> Callable[[], int]:
    vector.reset(seed=0)

    def run() -> int:
        for action in actions:
            vector.step(action[:workers].numpy())
        return STEPS * workers

    return run


def _single_environment(robot: str) -> gym.Env:
    torch.set_num_threads(1)  # in a worker process: one robot's tensors are too small to share out
    return Go2Env(overrides=[f"robot.name={robot}"])
