"""Imitation: fits a known map and does not lean on the last action."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from camp.algo.config import ImitationConfig
from camp.algo.imitation import ImitationData, ImitationLoss, imitate
from camp.algo.models import GaussianActor
from tests.algo.synthetic import rng, shipped_config

CONFIG = ImitationConfig(epochs=20, batch_size=128, learning_rate=1e-2, last_action_noise=0.0, ppo_weight=0.0)


def make_actor() -> GaussianActor:
    return GaussianActor(6, 2, replace(shipped_config().actor, hidden=[64, 64], initial_std=0.2), rng())


def linear_data(last_action: slice = slice(4, 6)) -> ImitationData:
    """Actions are linear in the first four inputs, which are far from standardized."""
    observation = torch.randn(2000, 6, generator=rng(1)) * torch.tensor([0.1, 10.0, 1.0, 1.0, 1.0, 1.0]) + 3.0
    weight = torch.tensor([[5.0, 0.05, 0.0, 0.3], [0.0, 0.1, 0.5, 0.0]])
    return ImitationData(observation, (observation[:, :4] - 3.0) @ weight.T, last_action, torch.zeros(6))


def test_fits_a_linear_map():
    actor, data = make_actor(), linear_data()
    metrics = list(imitate(actor, data, CONFIG, rng(2)))
    assert len(metrics) == 20
    assert metrics[-1]["imitation/loss"] < 0.01 < 0.1 < metrics[0]["imitation/loss"]
    assert metrics[-1]["imitation/epoch"] == 20.0
    assert metrics[-1]["imitation/learning_rate"] == pytest.approx(0.0, abs=1e-9)
    error = actor(data.observation) - data.action
    assert error.square().mean() < 0.01


def test_feeds_the_normalizer_once_and_leaves_exploration_alone():
    actor, data = make_actor(), linear_data()
    list(imitate(actor, data, replace(CONFIG, epochs=2), rng(2)))
    assert actor.normalizer.count.item() == 2000
    torch.testing.assert_close(actor.normalizer.mean.float(), data.observation.mean(dim=0), atol=1e-4, rtol=0)
    torch.testing.assert_close(actor.std, torch.full((2,), 0.2))


def test_noise_on_the_last_action_keeps_the_policy_from_copying_it():
    data = linear_data()
    data.observation[:, 4:6] = data.action  # gives the answer away
    gain = []
    for noise in (0.0, 2.0):
        actor = make_actor()
        list(imitate(actor, data, replace(CONFIG, last_action_noise=noise), rng(2)))
        shifted = data.observation.clone()
        shifted[:, 4:6] += 0.5
        gain.append(((actor(shifted) - actor(data.observation)) / 0.5).mean().item())
    assert gain[0] > 0.2
    assert gain[1] < 0.25 * gain[0]


def test_a_noisy_sensor_is_trusted_less():
    gain = []
    for noise in (0.0, 3.0):
        data = linear_data()
        data.observation[:, 3] = data.observation[:, 2]  # two sensors that say the same, one of them noisy
        data.sensor_noise[3] = noise
        actor = make_actor()
        list(imitate(actor, data, CONFIG, rng(2)))
        shifted = data.observation.clone()
        shifted[:, 3] += 0.5
        gain.append((actor(shifted) - actor(data.observation)).abs().mean().item())
    assert gain[1] < 0.5 * gain[0]


def test_the_given_data_are_not_changed_by_noise():
    data = linear_data()
    before = data.observation.clone()
    list(imitate(make_actor(), data, replace(CONFIG, epochs=1, last_action_noise=1.0), rng(2)))
    assert torch.equal(data.observation, before)


def test_same_generator_same_actor():
    actors = [make_actor(), make_actor()]
    for actor in actors:
        list(imitate(actor, linear_data(), replace(CONFIG, epochs=2, last_action_noise=0.1), rng(2)))
    assert all(torch.equal(a, b) for a, b in zip(actors[0].parameters(), actors[1].parameters(), strict=True))


def test_the_loss_beside_ppo_is_the_weighted_squared_error():
    actor, data = make_actor(), linear_data()
    pair = ImitationData(data.observation[:1], data.action[:1], data.last_action, data.sensor_noise)
    loss = ImitationLoss(pair, replace(CONFIG, ppo_weight=3.0), rng(2))(actor)
    error = actor(pair.observation) - pair.action
    torch.testing.assert_close(loss, 3.0 * (error[0, 0] ** 2 + error[0, 1] ** 2) / 2)


def test_the_loss_beside_ppo_draws_anew_at_every_call():
    actor, data = make_actor(), linear_data()
    loss = ImitationLoss(data, replace(CONFIG, ppo_weight=1.0, batch_size=16), rng(2))
    assert loss(actor).item() != loss(actor).item()


def test_no_pairs_is_refused():
    empty = ImitationData(torch.zeros(0, 6), torch.zeros(0, 2), slice(4, 6), torch.zeros(6))
    with pytest.raises(ValueError, match=r"no .observation, action. pairs"):
        next(imitate(make_actor(), empty, CONFIG, rng()))
