"""Measure speed: ``python -m camp.bench [overrides]``; prints ratios, since absolute speeds depend on the machine."""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
import torch
from gymnasium.vector import AsyncVectorEnv
from mujoco.batch import Batch
from omegaconf import DictConfig
from rich.console import Console
from rich.table import Table

from camp.build import Training, build_training
from camp.cli import run_hydra
from camp.config import Config, resolve
from camp.envs.quadruped import QuadrupedEnv
from camp.robots import go2
from camp.runner import Runner
from camp.single_env import Go2Env
from camp.threads import set_threads
from camp.versions import collect_versions

ROUNDS = 5  # of each contender in turn, so that a drifting machine slows all alike
STEPS = 40  # control steps per round
SAMPLE_SIZE = 2048  # expert transitions per batch
NOISE = 0.25  # rad, of the random targets


class PlainGo2Env(gym.Env):
    """The same model stepped by a plain MuJoCo loop, without rewards, commands or AMP states: the cheapest
    single environment there could be."""

    observation_space = gym.spaces.Box(-np.inf, np.inf, (37,), np.float32)
    action_space = gym.spaces.Box(-np.inf, np.inf, (12,), np.float32)

    def __init__(self) -> None:
        self.model = go2.load_model()
        self.data = mujoco.MjData(self.model)

    def reset(self, *, seed: int | None = None, options: dict | None = None) -> tuple[np.ndarray, dict]:
        super().reset(seed=seed)
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key("stand").id)
        return self._observe(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        self.data.ctrl[:] = go2.DEFAULT_JOINT_POSITION + NOISE * action
        mujoco.mj_step(self.model, self.data, 4)
        return self._observe(), 0.0, bool(self.data.qpos[2] < 0.15), False, {}

    def _observe(self) -> np.ndarray:
        return np.concatenate([self.data.qpos, self.data.qvel]).astype(np.float32)


def bench(composed: DictConfig) -> None:
    """Print simulation, environment and training speed of the configuration."""
    config = resolve(composed)
    set_threads(config.sim.threads)
    versions = collect_versions()
    print(
        f"{versions['platform']}, {os.cpu_count()} processors, mujoco {mujoco.__version__}, torch {torch.__version__}"
    )
    training = build_training(config)
    training.env.reset()
    _print_stepping(_stepping(training.env, config))
    _print_sampling(training)
    _print_iteration(_iteration(Runner(training, config, Path())), config)
    training.env.close()


def _stepping(env: QuadrupedEnv, config: Config) -> dict[str, list[float]]:
    """Control steps per second of each contender, one value per round."""
    pose = torch.tensor(go2.DEFAULT_JOINT_POSITION)
    generator = torch.Generator().manual_seed(0)
    actions = torch.randn(STEPS, env.num_envs, 12, generator=generator)
    batch = Batch(go2.load_model(config.sim.physics_timestep_s), nsim=env.num_envs, nthread=config.sim.threads)
    substeps = round(config.env.control_period_s / config.sim.physics_timestep_s)
    batch.reset(keyframe=0)
    ctrl = batch.bind("ctrl")

    def bare() -> int:
        for action in actions:
            ctrl[:] = (pose + NOISE * action).numpy()
            batch.step(nstep=substeps)
        return STEPS * env.num_envs

    def ours() -> int:
        for action in actions:
            env.step(action)
        return STEPS * env.num_envs

    workers = os.cpu_count() or 1
    same = AsyncVectorEnv([_single_environment] * workers)
    plain = AsyncVectorEnv([PlainGo2Env] * workers)

    def stepping(vector: AsyncVectorEnv) -> Callable[[], int]:
        vector.reset(seed=0)

        def run() -> int:
            for action in actions:
                vector.step(action[:workers].numpy())
            return STEPS * workers

        return run

    contenders = {
        "mujoco.batch, bare": bare,
        "camp env.step": ours,
        "AsyncVectorEnv of camp/Go2-v0": stepping(same),
        "AsyncVectorEnv of a plain loop": stepping(plain),
    }
    try:
        return _in_turn(contenders)
    finally:
        same.close()
        plain.close()


def _single_environment() -> gym.Env:
    torch.set_num_threads(1)  # in a worker process: one robot's tensors are too small to share out
    return Go2Env()


def _in_turn(contenders: dict[str, Callable[[], int]]) -> dict[str, list[float]]:
    speeds: dict[str, list[float]] = {name: [] for name in contenders}
    for turn in range(ROUNDS + 1):
        for name, run in contenders.items():
            started = time.perf_counter()
            steps = run()
            if turn > 0:  # the first turn warms up
                speeds[name].append(steps / (time.perf_counter() - started))
    return speeds


def _iteration(runner: Runner) -> dict[str, float]:
    """Seconds of one training iteration after a warm-up: physics, networks and rest."""
    training = runner.training
    runner.iteration = runner.config.run.critic_warmup  # from here on the policy learns too
    runner.iterate()
    clock = {"physics": 0.0, "networks": 0.0}
    _time(training.env.sim, "step", clock, "physics")
    for name in ("act", "value", "update", "update_critic"):
        _time(training.ppo, name, clock, "networks")
    for prior in training.priors:
        _time(prior, "reward", clock, "networks")
        _time(prior, "update", clock, "networks")
    started = time.perf_counter()
    runner.iterate()
    total = time.perf_counter() - started
    return clock | {"rest": total - sum(clock.values())}


def _time(owner: Any, name: str, clock: dict[str, float], part: str) -> None:
    """Add the time that ``owner.name`` takes to ``clock[part]`` from now on."""
    method = getattr(owner, name)

    def timed(*args: Any, **kwargs: Any) -> Any:
        started = time.perf_counter()
        try:
            return method(*args, **kwargs)
        finally:
            clock[part] += time.perf_counter() - started

    setattr(owner, name, timed)


def _print_sampling(training: Training) -> None:
    """How many expert transitions the discriminators could be given per second."""
    demonstrations, size = training.demonstrations, SAMPLE_SIZE
    generator = training.generators["priors"]
    demonstrations.sample(size, generator)
    started = time.perf_counter()
    for _ in range(STEPS):
        demonstrations.sample(size, generator)
    rate = STEPS * size / (time.perf_counter() - started)
    memory = demonstrations.memory_bytes / 2**20
    print(f"expert transitions: {len(demonstrations):,} preloaded ({memory:.0f} MiB), {rate:,.0f} sampled per second")


def _print_stepping(speeds: dict[str, list[float]]) -> None:
    table = Table(title=f"control steps per second, median of {ROUNDS} rounds in turn")
    for heading in ("contender", "steps/s", "of bare (median of pairs)"):
        table.add_column(heading, justify="left" if heading == "contender" else "right")
    bare = next(iter(speeds.values()))
    for name, values in speeds.items():
        ratio = statistics.median(value / base for value, base in zip(values, bare, strict=True))
        table.add_row(name, f"{statistics.median(values):,.0f}", f"{ratio:.3f}")
    Console().print(table)


def _print_iteration(seconds: dict[str, float], config: Config) -> None:
    total = sum(seconds.values())
    samples = config.run.rollout_steps * config.sim.num_envs
    table = Table(title=f"one training iteration: {samples:,} steps in {total:.2f} s = {samples / total:,.0f} steps/s")
    for heading in ("part", "s", "share"):
        table.add_column(heading, justify="left" if heading == "part" else "right")
    for name, value in seconds.items():
        table.add_row(name, f"{value:.2f}", f"{value / total:.0%}")
    Console().print(table)


if __name__ == "__main__":
    sys.exit(run_hydra("train", bench))
