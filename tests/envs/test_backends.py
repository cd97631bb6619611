"""The environment on both simulators: on the same states it shows, rewards and ends the same; and it never waits."""

from __future__ import annotations

import copy

import pytest
import torch
from torch.utils._python_dispatch import TorchDispatchMode

from camp.build import build_env, build_training
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.motion.clips.clip import Clip
from camp.sim.divergence import diverged
from camp.training.collector import Collector
from camp.training.gait_monitor import GaitMonitor

pytest.importorskip("mujoco_warp", reason="mujoco_warp is not installed; it comes with the gpu and dev extras")

NUM = 6
EXACT = ("terminated", "truncated", "skill", "command", "foot_contact")
CLOSE = ("task_reward", "transition", "velocity", "observation", "final_observation", "privileged", "final_privileged")
# Calls that make the host wait for an accelerator, or copy Python numbers to it.
WAITING = {
    "aten._local_scalar_dense",
    "aten.equal",
    "aten.is_nonzero",
    "aten.lift_fresh",
    "aten.masked_select",
    "aten.nonzero",
    "aten.unique_dim",
    "aten._unique2",
}


@pytest.fixture
def warp(config: Config) -> Config:
    """Every source of randomness at work, episodes that end, on Warp's CPU device."""
    config.sim = compose_config(["sim=gpu", "sim.device=cpu", f"sim.num_envs={NUM}"]).sim
    config.env.noise.enabled = config.env.randomization.enabled = config.env.push.enabled = True
    config.env.episode_s, config.env.push.period_s = 0.5, 0.1
    return config


class Waits(TorchDispatchMode):
    """Counts the calls of ``WAITING``, and indexing by a mask."""

    def __init__(self) -> None:
        super().__init__()
        self.calls: list[str] = []

    def __torch_dispatch__(self, func, types, args=(), kwargs=None):
        name = f"{func.namespace}.{func._opname}"
        by_mask = name.startswith("aten.index") and any(
            isinstance(index, torch.Tensor) and index.dtype in (torch.bool, torch.uint8)
            for index in (args[1] if len(args) > 1 and isinstance(args[1], list | tuple) else [])
        )
        if name in WAITING or by_mask:
            self.calls.append(name)
        return func(*args, **(kwargs or {}))


def test_both_backends_agree_on_the_same_states(warp: Config, clips: list[Clip]):
    warp.env.termination.tilt_rad = 0.2  # so that some robots fail
    other = copy.deepcopy(warp)
    other.sim = warp.sim.on_cpu()
    ours, reference = build_env(warp, clips), build_env(other, clips)
    for env in (ours, reference):
        env.reset(seed=0, options={"stagger": False})
    ended = {"terminated": 0, "truncated": 0}
    differing = 0
    actions = torch.randn(60, NUM, 12, generator=torch.Generator().manual_seed(1))
    for action in actions:
        ours.load_state_dict(reference.state_dict())
        mine, theirs = ours.advance(action), reference.advance(action)
        agree = torch.ones(NUM, dtype=torch.bool)
        for name in EXACT:
            agree &= (getattr(mine, name) == getattr(theirs, name)).view(NUM, -1).all(dim=1)
        for name in CLOSE:
            close = torch.isclose(getattr(mine, name), getattr(theirs, name), atol=5e-3, rtol=1e-3)
            agree &= close.view(NUM, -1).all(dim=1)
        error = (ours.sim.state.joint_position - reference.sim.state.joint_position).abs().amax(dim=1)  # rad
        differing += int((~agree | (error > 1e-4)).sum())
        for name in ended:
            ended[name] += int(getattr(theirs, name).sum())
    # Where a foot touches down within float32's rounding of a physics step's end, one backend is a step ahead.
    assert differing <= 2, f"{differing} of {actions[..., 0].numel()}"
    assert min(ended.values()) > 0
    assert ours.num_diverged == reference.num_diverged == 0


def test_a_diverged_robot_is_counted_and_begins_anew(warp: Config, clips: list[Clip]):
    env = build_env(warp, clips)
    env.reset(seed=0)
    env.sim._qvel[3] = float("nan")  # pyright: ignore[reportAttributeAccessIssue]
    step = env.advance(torch.zeros(NUM, 12))
    assert step.terminated[3] and env.num_diverged == 1
    for tensor in (step.observation, step.final_observation, step.privileged, step.transition, step.task_reward):
        assert torch.isfinite(tensor).all()
    assert not diverged(env.robot, env.sim.state).any()
    assert torch.isfinite(env.advance(torch.zeros(NUM, 12)).observation).all()


def test_state_continues_bit_for_bit(warp: Config, clips: list[Clip]):
    one, resumed = build_env(warp, clips), build_env(warp, clips)
    one.reset(seed=0)
    actions = torch.randn(30, NUM, 12, generator=torch.Generator().manual_seed(2))
    for action in actions[:15]:
        one.advance(action)
    resumed.load_state_dict(one.state_dict())
    for action in actions[15:]:
        mine, theirs = one.advance(action), resumed.advance(action)
        for name in ("observation", "privileged", "transition", "task_reward", "terminated", "skill"):
            assert torch.equal(getattr(mine, name), getattr(theirs, name)), name


def test_a_step_never_waits_for_the_device(warp: Config, clips: list[Clip]):
    env = build_env(warp, clips)
    monitor = GaitMonitor(warp.motion.skill_set(), NUM, 1.0, 0.02, env.sim.device)
    env.reset(seed=0)
    action = torch.randn(NUM, 12, generator=torch.Generator().manual_seed(3))
    monitor.add(env.advance(action))  # constants are made in the first step
    with Waits() as waits:
        for _ in range(25):  # longer than between two draws of starts, and than an episode
            monitor.add(env.advance(action))
    assert waits.calls == []


def test_a_rollout_waits_at_its_end_alone(warp: Config):
    training = build_training(warp)
    training.env.reset(seed=0)
    monitor = GaitMonitor(warp.motion.skill_set(), NUM, 1.0, 0.02, training.device)
    collector = Collector(training.env, training.ppo, monitor, training.device)
    generator = torch.Generator().manual_seed(0)
    collector.collect(2, generator)
    counts = []
    for steps in (26, 52):
        with Waits() as waits:
            collector.collect(steps, generator)
        counts.append(len(waits.calls))
    assert counts[0] == counts[1] > 0


@pytest.mark.gpu
@pytest.mark.skipif(not torch.cuda.is_available(), reason="torch finds no CUDA GPU")
def test_a_step_on_the_gpu_never_waits(warp: Config, clips: list[Clip]):
    warp.sim.device = warp.device = "cuda"
    env = build_env(warp, clips)
    env.reset(seed=0)
    action = torch.zeros(NUM, 12, device=env.sim.device)
    env.advance(action)
    torch.cuda.set_sync_debug_mode("error")
    try:
        for _ in range(25):
            env.advance(action)
    finally:
        torch.cuda.set_sync_debug_mode("default")
    assert torch.isfinite(env.observation).all()
