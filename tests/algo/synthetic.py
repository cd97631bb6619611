"""Small configs and synthetic motion shared by the tests of camp.algo."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import torch
from omegaconf import OmegaConf
from torch import Tensor

from camp.algo.config import AlgoConfig, PPOConfig, SkillConfig, StyleConfig
from camp.algo.mirror import Symmetry
from camp.algo.models import Critic, GaussianActor, SkillEmbedding
from camp.algo.ppo import PPO
from camp.algo.skill import SkillPrior
from camp.algo.style import StylePrior
from camp.data import Rollout, Transition

CONF = Path(__file__).parents[2] / "conf" / "algo" / "camp.yaml"
STATE_SIZE = 3
SKILLS = ("trot", "pace", "bound", "pronk")


def shipped_config() -> AlgoConfig:
    """conf/algo/camp.yaml against its schema."""
    config = OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(AlgoConfig), OmegaConf.load(CONF)))
    assert isinstance(config, AlgoConfig)
    return config


def rng(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


@dataclass
class Blobs:
    """One Gaussian per skill in transition space: centers (K, 2, S), std `spread`."""

    centers: Tensor
    spread: float = 0.1

    def sample(self, n: int, generator: torch.Generator) -> Transition:
        skill = torch.arange(n) % len(self.centers)
        noise = torch.randn(n, *self.centers.shape[1:], generator=generator)
        return Transition(self.centers[skill] + self.spread * noise, skill)


def four_corners() -> Blobs:
    """Four skills at the corners of a square in the first coordinate of the two frames."""
    centers = torch.zeros(4, 2, STATE_SIZE)
    centers[:, :, 0] = torch.tensor([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
    return Blobs(centers)


def style_config(**changes: object) -> StyleConfig:
    small = replace(
        shipped_config().style,
        hidden=[32, 16],
        learning_rate=3e-3,
        updates=5,
        batch_size=64,
        gradient_penalty=0.1,
    )
    return replace(small, **changes)  # type: ignore[arg-type]


def skill_config(**changes: object) -> SkillConfig:
    small = replace(shipped_config().skill, hidden=[32, 16], learning_rate=3e-3, updates=5, batch_size=64)
    return replace(small, **changes)  # type: ignore[arg-type]


def ppo_config(**changes: object) -> PPOConfig:
    return replace(shipped_config().ppo, **changes)  # type: ignore[arg-type]


def make_style(seed: int = 0, **changes: object) -> StylePrior:
    generator = rng(seed)
    embedding = SkillEmbedding(len(SKILLS), 8, generator)
    return StylePrior(style_config(**changes), embedding, SKILLS, (2, STATE_SIZE), generator)


def make_skill(seed: int = 0, **changes: object) -> SkillPrior:
    generator = rng(seed)
    embedding = SkillEmbedding(len(SKILLS), 8, generator)
    return SkillPrior(skill_config(**changes), embedding, SKILLS, (2, STATE_SIZE), generator)


def make_ppo(
    seed: int = 0,
    sizes: tuple[int, int, int] = (5, 2, 3),
    initial_std: float = 0.5,
    symmetry: Symmetry | None = None,
    **changes: object,
) -> PPO:
    """sizes: observation, privileged, action."""
    generator, shipped = rng(seed), shipped_config()
    observation, privileged, action = sizes
    actor_config = replace(shipped.actor, hidden=[32, 32], initial_std=initial_std)
    actor = GaussianActor(observation, action, actor_config, generator)
    critic = Critic(observation + privileged, replace(shipped.critic, hidden=[32, 32]), generator)
    return PPO(actor, critic, ppo_config(**changes), symmetry)


def make_rollout(ppo: PPO, seed: int, steps: int = 4, envs: int = 16, scale: float = 1.0) -> Rollout:
    """Random observations with the policy's and critic's own answers; nothing ends."""
    generator = rng(seed)
    observation_size = ppo.actor.normalizer.mean.shape[0]
    privileged_size = ppo.critic.normalizer.mean.shape[0] - observation_size
    observation = scale * (1.0 + torch.randn(steps, envs, observation_size, generator=generator))
    privileged = torch.randn(steps, envs, privileged_size, generator=generator)
    decision = ppo.act(observation, privileged, generator)
    never = torch.zeros(steps, envs, dtype=torch.bool)
    return Rollout(
        observation=observation,
        privileged=privileged,
        action=decision.action,
        log_prob=decision.log_prob,
        action_mean=decision.mean,
        action_std=decision.std,
        value=decision.value,
        next_value=decision.value,
        task_reward=torch.randn(steps, envs, generator=generator),
        terminated=never,
        truncated=never,
        transition=torch.randn(steps, envs, 2, STATE_SIZE, generator=generator),
        skill=torch.arange(envs).remainder(4).expand(steps, envs).contiguous(),
    )


def assert_identical(left: object, right: object) -> None:
    """Nested state dicts are the same bit for bit."""
    assert type(left) is type(right)
    if isinstance(left, Tensor):
        assert isinstance(right, Tensor) and torch.equal(left, right)
    elif isinstance(left, dict):
        assert isinstance(right, dict) and left.keys() == right.keys()
        for key in left:
            assert_identical(left[key], right[key])
    elif isinstance(left, (list, tuple)):
        assert isinstance(right, (list, tuple)) and len(left) == len(right)
        for a, b in zip(left, right, strict=True):
            assert_identical(a, b)
    else:
        assert left == right
