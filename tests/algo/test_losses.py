"""Losses and rewards against values worked by hand."""

from __future__ import annotations

import math

import pytest
import torch
from torch.distributions import Normal, kl_divergence

from camp.algo import losses
from tests.algo.synthetic import rng

T = torch.tensor


def test_lsgan_targets_are_plus_and_minus_one():
    assert losses.lsgan_loss(T([1.0, 1.0]), T([-1.0])).item() == 0.0
    # expert: mean of (0-1)^2 and (3-1)^2 = 2.5; policy: (1+1)^2 = 4
    assert losses.lsgan_loss(T([0.0, 3.0]), T([1.0])).item() == pytest.approx(6.5)


def test_penalty_of_a_linear_discriminator_is_the_squared_norm_of_its_weight():
    weight = T([3.0, -4.0])
    x = torch.randn(7, 2, generator=rng(), requires_grad=True)
    assert losses.gradient_penalty(x @ weight, x).item() == pytest.approx(25.0)
    assert losses.gradient_penalty((x @ weight).unsqueeze(1), x).item() == pytest.approx(25.0)


def test_penalty_counts_both_frames_of_a_transition():
    x = torch.zeros(3, 2, 4, requires_grad=True)
    assert losses.gradient_penalty(2.0 * x.flatten(1).sum(dim=1), x).item() == pytest.approx(8 * 4.0)


def test_penalty_averages_over_samples_and_is_differentiable():
    x = T([[1.0], [2.0]], requires_grad=True)
    scale = T(1.0, requires_grad=True)
    penalty = losses.gradient_penalty(scale * x.squeeze(1).square(), x)  # gradients 2 and 4
    assert penalty.item() == pytest.approx((4.0 + 16.0) / 2)
    penalty.backward()
    assert scale.grad is not None and scale.grad.item() == pytest.approx(20.0)  # d (scale^2 * 10) / d scale


def test_vector_penalty_of_orthogonal_rows_is_exact():
    jacobian = T([[3.0, 0.0, 0.0], [0.0, 0.0, 2.0]])  # ||J||_F^2 = 13, whatever the signs
    x = torch.randn(5, 3, generator=rng(), requires_grad=True)
    assert losses.gradient_penalty(x @ jacobian.T, x, rng(1)).item() == pytest.approx(13.0, rel=1e-6)


def test_vector_penalty_estimates_the_jacobian_without_bias():
    network = torch.nn.Sequential(torch.nn.Linear(3, 8), torch.nn.Tanh(), torch.nn.Linear(8, 4))
    for i, parameter in enumerate(network.parameters()):
        torch.nn.init.normal_(parameter, generator=rng(i))
    point = torch.randn(3, generator=rng(9))
    jacobian = torch.autograd.functional.jacobian(network, point)
    assert isinstance(jacobian, torch.Tensor)
    exact = jacobian.square().sum().item()
    x = point.repeat(20_000, 1).requires_grad_()
    assert losses.gradient_penalty(network(x), x, rng(10)).item() == pytest.approx(exact, rel=0.02)
    one_sign = losses.gradient_penalty(network(x).sum(dim=1), x).item()  # what a fixed v = 1 would give
    assert one_sign != pytest.approx(exact, rel=0.1)


def test_vector_penalty_needs_its_randomness_given():
    x = torch.zeros(2, 3, requires_grad=True)
    with pytest.raises(ValueError, match="generator"):
        losses.gradient_penalty(x * 1.0, x)


def test_style_reward_at_landmarks():
    reward = losses.style_reward(T([1.0, 0.0, -1.0, 3.0, -5.0, 2.0]))
    assert reward.tolist() == [1.0, 0.75, 0.0, 0.0, 0.0, 0.75]


def test_skill_reward_is_the_cosine():
    predicted = T([[2.0, 0.0], [0.0, 3.0], [-1.0, 0.0], [1.0, 1.0], [0.0, 0.0]])
    target = T([[5.0, 0.0]]).expand(5, 2)
    expected = T([1.0, 0.0, -1.0, math.sqrt(0.5), 0.0])
    torch.testing.assert_close(losses.skill_reward(predicted, target), expected)


def test_skill_reward_stays_within_one():
    z = torch.randn(1000, 64, generator=rng())
    assert losses.skill_reward(z, 3.7 * z).max() <= 1.0


def test_skill_regression_sums_over_the_embedding_and_averages_over_samples():
    predicted = T([[1.0, 2.0], [0.0, 0.0]], requires_grad=True)
    target = T([[0.0, 0.0], [3.0, 4.0]], requires_grad=True)
    loss = losses.skill_regression_loss(predicted, target)
    assert loss.item() == pytest.approx((5.0 + 25.0) / 2)
    loss.backward()
    assert predicted.grad is not None and target.grad is None


def test_gae_worked_by_hand():
    # One environment, discount .5, trace .5 (decay .25), V = 1 throughout.
    #   t=0 ordinary:   delta = 1 + .5*2 - 1 = 1
    #   t=1 truncated:  delta = 1 + .5*4 - 1 = 2  (bootstraps the final observation's value, cuts the trace)
    #   t=2 terminated: delta = 3 + 0    - 1 = 2  (nothing to bootstrap, here not even a finite value)
    #   t=3 ordinary:   delta = 3 + .5*2 - 1 = 3  (end of the rollout)
    # Advantages from the back: A3 = 3, A2 = 2, A1 = 2, A0 = 1 + .25*2 = 1.5.
    column = lambda *values: T(values).unsqueeze(1)  # noqa: E731
    advantage, return_ = losses.gae(
        reward=column(1.0, 1.0, 3.0, 3.0),
        value=column(1.0, 1.0, 1.0, 1.0),
        next_value=column(2.0, 4.0, float("nan"), 2.0),
        terminated=column(False, False, True, False),
        truncated=column(False, True, False, False),
        gamma=0.5,
        gae_lambda=0.5,
    )
    assert advantage.squeeze(1).tolist() == [1.5, 2.0, 2.0, 3.0]
    assert return_.squeeze(1).tolist() == [2.5, 3.0, 3.0, 4.0]


def test_gae_with_full_trace_is_the_discounted_return():
    reward = torch.randn(6, 3, generator=rng())
    value = torch.randn(7, 3, generator=rng(1))
    never = torch.zeros(6, 3, dtype=torch.bool)
    _, return_ = losses.gae(reward, value[:-1], value[1:], never, never, gamma=0.9, gae_lambda=1.0)
    expected = sum((0.9**t * reward[t] for t in range(6)), 0.9**6 * value[6])
    torch.testing.assert_close(return_[0], expected)


def test_a_step_both_terminated_and_truncated_counts_as_terminated():
    yes, zero = torch.ones(1, 1, dtype=torch.bool), torch.zeros(1, 1)
    advantage, _ = losses.gae(zero, zero, zero + 9.0, yes, yes, gamma=0.9, gae_lambda=0.9)
    assert advantage.item() == 0.0


@pytest.mark.parametrize(
    ("ratio", "advantage", "objective"),
    [(1.1, 1.0, 1.1), (1.5, 1.0, 1.2), (0.5, 1.0, 0.5), (1.5, -1.0, -1.5), (0.5, -1.0, -0.8)],
)
def test_surrogate_takes_the_pessimistic_side(ratio: float, advantage: float, objective: float):
    loss = losses.clipped_surrogate_loss(T([math.log(ratio)]), T([0.0]), T([advantage]), clip=0.2)
    assert loss.item() == pytest.approx(-objective)


@pytest.mark.parametrize(
    ("value", "clip", "loss"), [(1.1, 0.2, 0.81), (1.5, 0.2, 0.64), (1.5, 0.0, 0.25), (3.5, 0.2, 2.25)]
)
def test_value_loss_takes_the_larger_error(value: float, clip: float, loss: float):
    # old value 1, return 2: 1.5 is held at 1.2 (error .64 > .25); 3.5 overshoots (error 2.25 > .64)
    result = losses.clipped_value_loss(T([value]), T([1.0]), T([2.0]), clip)
    assert result.item() == pytest.approx(loss)


def test_gaussian_closed_forms_agree_with_torch_distributions():
    old_mean, mean, action = (torch.randn(5, 3, generator=rng(i)) for i in range(3))
    old_std, std = (torch.rand(5, 3, generator=rng(i)) + 0.1 for i in range(3, 5))
    old, new = Normal(old_mean, old_std), Normal(mean, std)
    torch.testing.assert_close(losses.gaussian_kl(old_mean, old_std, mean, std), kl_divergence(old, new).sum(-1))
    torch.testing.assert_close(losses.gaussian_log_prob(action, mean, std), new.log_prob(action).sum(-1))
    torch.testing.assert_close(losses.gaussian_entropy(std), new.entropy().sum(-1))


def test_symmetry_loss_is_the_divergence_of_two_policies():
    mean, mirrored, std = T([[0.1, -0.4], [0.0, 0.2]]), T([[0.3, -0.4], [0.1, 0.1]]), T([0.2, 0.1])
    # (.2/.2)^2 / 2 = .5; (.1/.2)^2 / 2 + (.1/.1)^2 / 2 = .625
    assert losses.symmetry_loss(mean, mirrored, std).item() == pytest.approx((0.5 + 0.625) / 2)
    expected = kl_divergence(Normal(mean, std), Normal(mirrored, std)).sum(dim=1).mean()
    torch.testing.assert_close(losses.symmetry_loss(mean, mirrored, std), expected)
