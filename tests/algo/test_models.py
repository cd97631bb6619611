"""Networks: shapes, initialization and the scale-preserving critic."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
import torch

from camp.algo.models import (
    ConditionalDiscriminator,
    Critic,
    GaussianActor,
    SkillDiscriminator,
    SkillEmbedding,
)
from camp.common.errors import ConfigError
from tests.algo.synthetic import rng, shipped_config


def test_shipped_sizes_are_those_of_table_three():
    config = shipped_config()
    actor = GaussianActor(49, 12, config.actor, rng())
    critic = Critic(49 + 30, config.critic, rng())
    style = ConditionalDiscriminator(43, config.embedding_size, config.style.hidden, rng())
    skill = SkillDiscriminator(43, config.embedding_size, config.skill.hidden, rng())

    def widths(module: torch.nn.Module) -> list[int]:
        return [m.out_features for m in module.modules() if isinstance(m, torch.nn.Linear)]

    assert widths(actor) == [512, 256, 128, 12]
    assert widths(critic) == [512, 256, 128, 1]
    assert widths(style) == [1024, 512, 1]
    assert widths(skill) == [512, 256, 64]
    state = torch.zeros(5, 2, 43)
    assert style(state, torch.zeros(5, 64)).shape == (5,)
    assert skill(state).shape == (5, 64)
    assert actor(torch.zeros(5, 49)).shape == (5, 12)
    assert critic(torch.zeros(5, 49), torch.zeros(5, 30)).shape == (5,)


def test_the_same_generator_seed_gives_the_same_network():
    config = shipped_config().actor
    left, right = (GaussianActor(6, 2, config, rng(3)) for _ in range(2))
    assert all(torch.equal(a, b) for a, b in zip(left.parameters(), right.parameters(), strict=True))


def test_embeddings_start_orthogonal_with_unit_variance_entries():
    weight = SkillEmbedding(4, 64, rng()).weight
    torch.testing.assert_close(weight @ weight.T, 64.0 * torch.eye(4), atol=1e-3, rtol=0)


def test_more_skills_than_dimensions_is_refused():
    with pytest.raises(ConfigError, match="embedding_size = 3"):
        SkillEmbedding(4, 3, rng())


def test_std_is_set_and_projected_into_its_bounds():
    config = replace(shipped_config().actor, initial_std=0.5, min_std=0.1, max_std=0.8)
    actor = GaussianActor(3, 2, config, rng())
    actor.set_std(0.3)
    torch.testing.assert_close(actor.std, torch.full((2,), 0.3))
    with torch.no_grad():
        actor.log_std.copy_(torch.tensor([math.log(0.01), math.log(5.0)]))
    actor.project_std()
    torch.testing.assert_close(actor.std, torch.tensor([0.1, 0.8]))
    with pytest.raises(ConfigError, match=r"0\.9"):
        actor.set_std(0.9)


def test_rescaling_the_critic_preserves_its_values():
    critic = Critic(4, shipped_config().critic, rng())
    observation, privileged = torch.randn(6, 3, generator=rng(1)), torch.randn(6, 1, generator=rng(2))
    critic.rescale(100.0 + 5.0 * torch.randn(200, generator=rng(3)))
    before = critic(observation, privileged)
    scale = critic.return_std.item()
    critic.rescale(300.0 + 40.0 * torch.randn(200, generator=rng(4)))
    assert critic.return_std.item() > 2.0 * scale
    torch.testing.assert_close(critic(observation, privileged), before, atol=1e-3, rtol=1e-4)


def test_the_first_rescaling_moves_a_fresh_critic_to_the_mean_return():
    critic = Critic(4, shipped_config().critic, rng())
    critic.rescale(torch.tensor([199.0, 201.0]))
    value = critic(torch.zeros(1, 3), torch.zeros(1, 1))
    assert value.item() == pytest.approx(200.0, abs=3.0)
