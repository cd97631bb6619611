"""How much memory a training takes, from its configuration alone, against what the machine has."""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import torch

from camp.common.errors import ConfigError
from camp.config.devices import learner_device
from camp.config.schema import Config
from camp.envs.observations import sizes
from camp.robots.quadruped import NUM_JOINTS

FLOAT = 4  # bytes
TRAINED = 4  # copies of a weight: itself, its gradient and Adam's two moments
KEPT = 3  # copies of a rollout: step by step, stacked, and as minibatches
CONSTRAINT_BYTES = 200  # of a row of the gpu backend's solver: Jacobian over 18 velocities, forces and scratch
CONTACT_BYTES = 500  # of one of its contacts


def parts(config: Config) -> dict[str, int]:
    """Bytes of what grows with the configuration, by the key that it grows with; of one process.

    Rough, and rather too little than too much: what is refused cannot run.
    """
    run, inputs = config.run, sum(sizes(config.env.observation, len(config.motion.skill_set())))
    frames, state = config.env.transition_shape()
    motion = frames * state
    step = 2 * inputs + motion + 3 * NUM_JOINTS + 20
    robots, samples = config.sim.num_envs, run.rollout_steps * config.sim.num_envs
    bytes_per_robot = 2 * FLOAT * (config.env.transition_ages[0] * state + 300)
    if config.sim.backend == "gpu":
        bytes_per_robot += CONSTRAINT_BYTES * (config.sim.constraints_per_robot or 0)
        bytes_per_robot += CONTACT_BYTES * (config.sim.contacts_per_robot or 0)
    algo = config.algo
    batch = -(-samples // algo.ppo.minibatches)
    found = {
        "sim.num_envs": robots * bytes_per_robot + KEPT * FLOAT * samples * step,
        "algo.actor.hidden": _network([inputs, *algo.actor.hidden, NUM_JOINTS], batch),
        "algo.critic.hidden": _network([inputs, *algo.critic.hidden, 1], batch),
        "algo.style.replay_size": FLOAT * motion * algo.style.replay_size,
        "motion.num_preloaded": FLOAT * motion * config.motion.num_preloaded,
    }
    for name, prior in (("style", algo.style), ("skill", algo.skill)):
        if prior.enabled:
            layers = [motion + algo.embedding_size, *prior.hidden, algo.embedding_size]
            found[f"algo.{name}.hidden"] = _network(layers, 0)
            found[f"algo.{name}.batch_size"] = 4 * FLOAT * prior.batch_size * sum(layers)
    return found


def check_memory(config: Config) -> None:
    """Raise ConfigError where the training of one process cannot fit the memory of the learner's device."""
    needed, there, where = parts(config), *_memory(config)
    total = sum(needed.values())
    if total > there:
        key = max(needed, key=lambda one: needed[one])
        value = config
        for name in key.split("."):
            value = getattr(value, name)
        raise ConfigError(
            f"{key} = {value!r}: this takes about {needed[key] / 2**30:.1f} GiB of the {total / 2**30:.1f} GiB that "
            f"training needs, and {where} has {there / 2**30:.1f} GiB; choose less"
        )


def machine_memory() -> int:
    """Bytes that this process may use: the machine's, or less in a container."""
    machine = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for limit in (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes")):
        try:
            machine = min(machine, int(limit.read_text()))
        except (OSError, ValueError):  # no such file, or "max"
            continue
    return machine


def _memory(config: Config) -> tuple[int, str]:
    device = learner_device(config.device)
    if device.type == "cuda":
        return torch.cuda.get_device_properties(device).total_memory, f"the GPU {device}"
    return machine_memory(), "this machine"


def _network(layers: Sequence[int], batch: int) -> int:
    """Bytes of a trained network and of the activations of one batch, with their gradients."""
    weights = sum(first * second for first, second in pairwise(layers))
    return FLOAT * (TRAINED * weights + 2 * batch * sum(layers))
