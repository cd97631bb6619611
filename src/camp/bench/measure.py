"""The measurements of the benchmark. It prints ratios, since absolute speeds depend on the machine."""

from __future__ import annotations

import copy
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import torch
from omegaconf import DictConfig
from rich.console import Console
from rich.table import Table

from camp.bench import arithmetic
from camp.bench.baselines import STEPS, Rounds, baselines
from camp.build import Training, build_training
from camp.common.threads import set_threads
from camp.config.resolve import resolve
from camp.config.schema import Config
from camp.runs.versions import collect_versions
from camp.training.runner import Runner

ROUNDS = 5  # of each in turn, so that a drifting machine slows all alike
SAMPLE_SIZE = 2048  # expert transitions per batch


def bench(composed: DictConfig) -> None:
    """Print simulation, environment and training speed of the configuration."""
    config = resolve(composed)
    set_threads(config.sim.threads)
    print(f"{collect_versions()['platform']}, {os.cpu_count()} processors", end=", ")
    print(f"mujoco {mujoco.__version__}, torch {torch.__version__}")
    for num_envs in robot_counts(config):
        _bench(config, num_envs)


def robot_counts(config: Config) -> tuple[int, ...]:
    """How many robots to measure with: sim.num_envs, on a GPU also a quarter, twice and four times as many."""
    num = config.sim.num_envs
    return (max(1, num // 4), num, 2 * num, 4 * num) if config.sim.backend == "gpu" else (num,)


def _bench(config: Config, num_envs: int) -> None:
    config = copy.deepcopy(config)
    config.sim.num_envs = num_envs
    training = build_training(config)
    device = training.env.sim.device
    training.env.reset()
    with baselines(training.env, config) as named:
        _print_stepping(_in_turn(named, device), config)
    _print_sampling(training)
    runner = Runner(training, config, Path())
    _print_iteration(*_iteration(runner), config)
    if device.type == training.device.type == "cpu":
        _print_rates(arithmetic.rates(runner), config)
    if device.type == "cuda":
        free, total = torch.cuda.mem_get_info(device)
        name = torch.cuda.get_device_name(device)
        print(f"memory in use on {name}, by all that runs there: {(total - free) / 2**30:.1f} GiB")


def _now(device: torch.device) -> float:
    """s, once the device has done what it was given."""
    if device.type == "cuda":
        torch.cuda.synchronize(device)
    return time.perf_counter()


def _in_turn(named: Rounds, device: torch.device) -> dict[str, list[float]]:
    """Control steps per second of each candidate, one value per round."""
    speeds: dict[str, list[float]] = {name: [] for name in named}
    for turn in range(ROUNDS + 1):
        for name, run in named.items():
            started = _now(device)
            steps = run()
            if turn > 0:  # the first turn warms up
                speeds[name].append(steps / (_now(device) - started))
    return speeds


def _iteration(runner: Runner) -> tuple[float, dict[str, float]]:
    """Seconds of one training iteration after a warm-up; seconds of the parts of another: physics, networks, rest.

    Taking the parts' times makes the host wait for the device, so on a GPU the other one takes longer.
    """
    training = runner.training
    devices = (training.device, training.env.sim.device)
    device = next((one for one in devices if one.type == "cuda"), training.device)
    runner.iteration = runner.config.run.critic_warmup  # from here on the policy learns too
    runner.iterate()
    whole = _timed(runner.iterate, device)
    parts = {"physics": 0.0, "networks": 0.0}
    _time(training.env.sim, "step", parts, "physics", device)
    for name in ("act", "value", "update", "update_critic"):
        _time(training.ppo, name, parts, "networks", device)
    for prior in training.priors:
        _time(prior, "reward", parts, "networks", device)
        _time(prior, "update", parts, "networks", device)
    other = _timed(runner.iterate, device)
    return whole, parts | {"rest": other - sum(parts.values())}


def _timed(call: Callable[[], object], device: torch.device) -> float:
    started = _now(device)
    call()
    return _now(device) - started


def _time(owner: Any, name: str, clock: dict[str, float], part: str, device: torch.device) -> None:
    """Add the time that ``owner.name`` takes to ``clock[part]`` from now on."""
    method = getattr(owner, name)

    def timed(*args: Any, **kwargs: Any) -> Any:
        started = _now(device)
        try:
            return method(*args, **kwargs)
        finally:
            clock[part] += _now(device) - started

    setattr(owner, name, timed)


def _print_sampling(training: Training) -> None:
    """How many expert transitions the discriminators could be given per second."""
    demonstrations, size = training.demonstrations, SAMPLE_SIZE
    generator = training.generators["priors"]
    demonstrations.sample(size, generator)
    started = _now(training.device)
    for _ in range(STEPS):
        demonstrations.sample(size, generator)
    rate = STEPS * size / (_now(training.device) - started)
    memory = demonstrations.memory_bytes / 2**20
    print(f"expert transitions: {len(demonstrations):,} preloaded ({memory:.0f} MiB), {rate:,.0f} sampled per second")


def _print_stepping(speeds: dict[str, list[float]], config: Config) -> None:
    print(f"\n{config.sim.num_envs:,} robots, control steps per second, median of {ROUNDS} rounds in turn:")
    table = Table()
    for heading in ("candidate", "steps/s", "of bare (median of pairs)"):
        table.add_column(heading, justify="left" if heading == "candidate" else "right")
    bare = next(iter(speeds.values()))
    for name, values in speeds.items():
        ratio = statistics.median(value / base for value, base in zip(values, bare, strict=True))
        table.add_row(name, f"{statistics.median(values):,.0f}", f"{ratio:.3f}")
    Console().print(table)


def _print_iteration(whole: float, parts: dict[str, float], config: Config) -> None:
    samples = config.run.rollout_steps * config.sim.num_envs
    print(f"one training iteration: {samples:,} steps in {whole:.2f} s = {samples / whole:,.0f} steps/s")
    table = Table(title="parts of another")
    for heading in ("part", "s", "share"):
        table.add_column(heading, justify="left" if heading == "part" else "right")
    for name, value in parts.items():
        table.add_row(name, f"{value:.2f}", f"{value / sum(parts.values()):.0%}")
    Console().print(table)


def _print_rates(rates: dict[str, float], config: Config) -> None:
    *updates, product = rates.items()
    table = Table(title=f"matrix products of the updates, {config.algo.precision}")
    for heading in ("", "GFLOP/s", f"of a product of {arithmetic.SIZE} x {arithmetic.SIZE}"):
        table.add_column(heading, justify="right" if heading else "left")
    for name, rate in (*updates, product):
        table.add_row(name, f"{rate / 1e9:,.0f}", f"{rate / product[1]:.0%}")
    Console().print(table)
