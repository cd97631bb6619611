"""Networks in bfloat16: what they answer, what stays float32, and that training still works."""

from __future__ import annotations

import pytest
import torch

from camp.algo.models import MLP, set_precision
from camp.algo.ppo import PPO
from tests.algo.synthetic import four_corners, make_ppo, make_rollout, make_skill, make_style, rng


@pytest.fixture(autouse=True)
def full_precision_afterwards():
    yield
    set_precision([], "float32")


def reduced_ppo(**changes: object) -> PPO:
    ppo = make_ppo(**changes)
    set_precision(ppo.networks(), "bfloat16")
    return ppo


def test_answers_are_float32_near_the_exact_ones():
    exact, reduced = make_ppo(), reduced_ppo()
    for ppo in (exact, reduced):
        ppo.actor.network[-1].weight.data.mul_(100.0)  # type: ignore[union-attr, operator]
    observation, privileged = torch.randn(64, 5, generator=rng()), torch.zeros(64, 2)
    answer, expected = reduced.actor(observation), exact.actor(observation)
    assert answer.dtype == torch.float32 and not torch.equal(answer, expected)
    torch.testing.assert_close(answer, expected, rtol=0.0, atol=0.03 * expected.abs().max().item())  # 2^-8 a layer
    assert reduced.critic(observation, privileged).dtype == torch.float32
    assert reduced.state_dict()["actor"].keys() == exact.state_dict()["actor"].keys()


def test_a_policy_that_cannot_move_measures_no_change():
    """Collecting and updating compute alike, or rounding would pass for a change of the policy."""
    rate = 1e-12
    ppo = reduced_ppo(learning_rate=rate, min_learning_rate=rate, max_learning_rate=rate)
    ppo.actor.network[-1].weight.data.mul_(100.0)  # type: ignore[union-attr, operator]
    rollout = make_rollout(ppo, 0)
    metrics = ppo.update(rollout, rollout.task_reward, rollout.task_reward, rng())
    assert metrics["ppo/kl"] == pytest.approx(0.0, abs=1e-6) and metrics["ppo/clip_fraction"] == 0.0


def test_parameters_gradients_and_statistics_keep_their_precision():
    ppo = reduced_ppo()
    rollout = make_rollout(ppo, 0)
    ppo.update(rollout, rollout.task_reward, rollout.task_reward, rng())
    for network in ppo.networks():
        for parameter in network.parameters():
            assert parameter.dtype == torch.float32
            assert parameter.grad is None or parameter.grad.dtype == torch.float32
    assert ppo.actor.normalizer.mean.dtype == ppo.critic.returns.mean.dtype == torch.float64


@pytest.mark.parametrize("make", [make_style, make_skill])
def test_priors_learn_through_the_penalty_of_second_order(make):
    prior, motion = make(), four_corners()
    set_precision(prior.networks(), "bfloat16")
    policy = motion.sample(256, rng(1))
    policy.state.neg_()
    metrics = [prior.update(policy, motion, rng(i)) for i in range(15)]
    key = f"prior/{prior.name}/loss"
    assert metrics[-1][key] < 0.7 * metrics[0][key]
    assert metrics[-1][f"prior/{prior.name}/gradient_penalty"] > 0.0


def test_the_switch_goes_both_ways():
    ppo = reduced_ppo()
    assert all(m.reduced for m in ppo.actor.modules() if isinstance(m, MLP))
    set_precision(ppo.networks(), "tf32")
    assert not any(m.reduced for m in ppo.actor.modules() if isinstance(m, MLP))
    assert torch.get_float32_matmul_precision() == "high"
    set_precision(ppo.networks(), "float32")
    assert torch.get_float32_matmul_precision() == "highest"
