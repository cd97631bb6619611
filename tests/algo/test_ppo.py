"""PPO: bookkeeping that must hold exactly, and two small problems it has to solve."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest
import torch

from camp.algo.losses import gae, gaussian_log_prob
from camp.algo.mirror import Reflection, Symmetry
from camp.algo.ppo import PPO, desired_kl_at, explained_variance, minibatches
from camp.data import Rollout
from camp.robots.mirror import Mirror
from tests.algo.synthetic import assert_identical, make_ppo, make_rollout, rng


def advantage_of(rollout: Rollout) -> tuple[torch.Tensor, torch.Tensor]:
    return gae(
        rollout.task_reward,
        rollout.value,
        rollout.next_value,
        rollout.terminated,
        rollout.truncated,
        0.99,
        0.95,
    )


def train(ppo: PPO, seeds: range) -> None:
    for seed in seeds:
        rollout = make_rollout(ppo, seed)
        ppo.update(rollout, *advantage_of(rollout), rng(seed + 100))


def test_minibatches_cover_every_row_once_per_epoch_in_a_new_order():
    parts = list(minibatches(10, epochs=2, count=4, generator=rng()))
    assert [len(p) for p in parts] == [3, 3, 2, 2] * 2
    first, second = torch.cat(parts[:4]), torch.cat(parts[4:])
    assert sorted(first.tolist()) == sorted(second.tolist()) == list(range(10))
    assert not torch.equal(first, second)


def test_fewer_rows_than_minibatches_leave_no_minibatch_empty():
    assert [len(p) for p in minibatches(2, epochs=1, count=4, generator=rng())] == [1, 1]


def test_explained_variance_landmarks():
    return_ = torch.tensor([1.0, 2.0, 3.0])
    assert explained_variance(return_ + 7.0, return_).item() == pytest.approx(1.0)
    assert explained_variance(torch.zeros(3), return_).item() == pytest.approx(0.0)


def test_act_samples_from_the_distribution_it_reports():
    ppo = make_ppo()
    decision = ppo.act(torch.randn(20_000, 5, generator=rng()), torch.zeros(20_000, 2), rng(1))
    standardized = (decision.action - decision.mean) / decision.std
    torch.testing.assert_close(standardized.mean(dim=0), torch.zeros(3), atol=0.03, rtol=0)
    torch.testing.assert_close(standardized.std(dim=0), torch.ones(3), atol=0.03, rtol=0)
    expected = gaussian_log_prob(decision.action, decision.mean, decision.std)
    torch.testing.assert_close(decision.log_prob, expected)


def test_a_policy_that_cannot_move_measures_no_change():
    # Observations far from standardized: had the normalizers been fed before the update, old
    # log-probabilities would be compared with those of another policy, and KL and clip fraction would not
    # vanish.
    rate = 1e-12
    ppo = make_ppo(learning_rate=rate, min_learning_rate=rate, max_learning_rate=rate)
    ppo.actor.network[-1].weight.data.mul_(100.0)  # type: ignore[union-attr, operator]
    rollout = make_rollout(ppo, 0, scale=5.0)
    metrics = ppo.update(rollout, *advantage_of(rollout), rng())
    assert metrics["ppo/kl"] == pytest.approx(0.0, abs=1e-6)
    assert metrics["ppo/clip_fraction"] == 0.0
    # ... and afterwards they have been fed.
    assert ppo.actor.normalizer.count.item() == ppo.critic.normalizer.count.item() == 64


def test_actor_normalizer_can_be_frozen():
    ppo = make_ppo(update_normalizer=False)
    train(ppo, range(1))
    assert ppo.actor.normalizer.count.item() == 0
    assert ppo.critic.normalizer.count.item() == 64


def test_critic_update_leaves_the_policy_and_its_rate_alone():
    ppo = make_ppo()
    actor, optimizer = copy.deepcopy(ppo.actor.state_dict()), copy.deepcopy(ppo.actor_optimizer.state_dict())
    critic = copy.deepcopy(ppo.critic.state_dict())
    rollout = make_rollout(ppo, 0)
    metrics = ppo.update_critic(rollout, advantage_of(rollout)[1], rng())
    assert_identical(ppo.actor.state_dict(), actor)
    assert_identical(ppo.actor_optimizer.state_dict(), optimizer)
    assert not torch.equal(ppo.critic.state_dict()["network.0.weight"], critic["network.0.weight"])
    assert metrics["ppo/learning_rate"] == ppo.config.learning_rate


def test_a_small_kl_raises_the_rate_to_its_ceiling_and_a_large_one_lowers_it_to_its_floor():
    eager = make_ppo(desired_kl=1e6, max_learning_rate=1e-3)
    train(eager, range(1))
    assert eager.learning_rate == pytest.approx(1e-3)
    careful = make_ppo(desired_kl=1e-9)
    train(careful, range(1))
    assert careful.learning_rate == pytest.approx(1e-5)


def test_once_an_iteration_the_rate_takes_one_correction_by_the_last_epoch():
    """The first epoch's KL, which begins at 0, does not count: the last one's alone decides."""
    ppo = make_ppo(adapt_each="iteration", desired_kl=1e6)
    train(ppo, range(1))
    assert ppo.learning_rate == pytest.approx(1.5 * 3e-4)
    rollout = make_rollout(ppo, 1)
    kls = []
    plain = ppo._adapt
    ppo._adapt = lambda kl: (kls.append(kl.item()), plain(kl))  # type: ignore[method-assign]
    metrics = ppo.update(rollout, *advantage_of(rollout), rng(1))
    assert len(kls) == 1 and kls[0] > metrics["ppo/kl"] > 0.0  # the mean over all epochs is smaller
    assert make_ppo(adapt_each="iteration", adaptive=False).learning_rate == 3e-4


def test_the_desired_kl_falls_over_the_last_iterations():
    config = make_ppo(desired_kl=0.04, final_desired_kl=0.01, settle_fraction=0.4).config
    assert [desired_kl_at(progress, config) for progress in (0.0, 0.6)] == [0.04, 0.04]
    assert desired_kl_at(0.8, config) == pytest.approx(0.02)  # half of the way, geometrically
    assert desired_kl_at(1.0, config) == pytest.approx(0.01)
    assert desired_kl_at(0.9, make_ppo(desired_kl=0.04).config) == 0.04


def test_the_rate_stays_without_the_adaptive_rule():
    ppo = make_ppo(adaptive=False, desired_kl=1e-9)
    train(ppo, range(1))
    assert ppo.learning_rate == 3e-4


def test_set_learning_rate_respects_the_bounds():
    ppo = make_ppo()
    ppo.set_learning_rate(5e-5)
    assert ppo.learning_rate == 5e-5
    ppo.set_learning_rate(1.0)
    assert ppo.learning_rate == ppo.config.max_learning_rate


def test_an_auxiliary_loss_pulls_the_policy():
    """Without any advantage the surrogate is flat: what moves is moved by the auxiliary loss."""
    ppo, observation = make_ppo(), torch.randn(64, 5, generator=rng(3))
    ppo.auxiliary_loss = lambda actor: (actor(observation) - 0.5).square().mean()
    before = ppo.auxiliary_loss(ppo.actor).item()
    for seed in range(20):
        rollout = make_rollout(ppo, seed)
        flat = torch.zeros_like(rollout.value)
        metrics = ppo.update(rollout, flat, rollout.value, rng(seed))
    assert ppo.auxiliary_loss(ppo.actor).item() < 0.5 * before
    assert 0.0 < metrics["ppo/auxiliary_loss"] < before


def test_a_fixed_std_is_not_trained():
    ppo = make_ppo()
    ppo.actor.log_std.requires_grad_(False)
    frozen = PPO(ppo.actor, ppo.critic, ppo.config)
    train(frozen, range(1))
    torch.testing.assert_close(frozen.actor.std, torch.full((3,), 0.5))


def test_a_restored_trainer_continues_bit_for_bit():
    ppo = make_ppo()
    train(ppo, range(2))
    saved = copy.deepcopy(ppo.state_dict())
    restored = make_ppo(seed=5)
    restored.load_state_dict(saved)
    assert restored.learning_rate == ppo.learning_rate != ppo.config.learning_rate
    train(ppo, range(2, 3))
    train(restored, range(2, 3))
    assert_identical(ppo.state_dict(), restored.state_dict())


def bandit_reward(ppo: PPO, generator: torch.Generator, envs: int = 256) -> tuple[Rollout, torch.Tensor]:
    """One-step episodes: the best action is (o_0, -o_1); reward 1 - distance^2."""
    observation = torch.randn(1, envs, 2, generator=generator)
    target = observation * torch.tensor([1.0, -1.0])
    decision = ppo.act(observation, observation[..., :1], generator)
    reward = 1.0 - (decision.action - target).square().sum(dim=-1)
    ended = torch.ones(1, envs, dtype=torch.bool)
    rollout = Rollout(
        observation=observation,
        privileged=observation[..., :1],
        action=decision.action,
        log_prob=decision.log_prob,
        action_mean=decision.mean,
        action_std=decision.std,
        value=decision.value,
        next_value=torch.zeros(1, envs),
        task_reward=reward,
        terminated=ended,
        truncated=~ended,
        transition=torch.zeros(1, envs, 2, 1),
        skill=torch.zeros(1, envs, dtype=torch.int64),
    )
    return rollout, reward.mean()


def test_learns_a_contextual_bandit():
    ppo = make_ppo(sizes=(2, 1, 2), max_learning_rate=1e-2, learning_rate=3e-3, entropy_coef=0.0)
    generator = rng(7)
    rewards, metrics = [], {}
    for _ in range(80):
        rollout, reward = bandit_reward(ppo, generator)
        rewards.append(reward.item())
        metrics = ppo.update(rollout, *advantage_of(rollout), generator)
    # At first actions ~ N(0, .5) miss targets of variance 1: 1 - 2 (1 + .25) = -1.5. At best 1 - 2 std^2.
    assert rewards[0] < -1.0
    assert sum(rewards[-5:]) / 5 > 0.85
    assert metrics["ppo/std"] < 0.25


def test_the_first_return_scale_does_not_stall_the_critic():
    # The jump to the mean return must not count as a change that the value clip holds back.
    ppo = make_ppo()
    rollout = make_rollout(ppo, 0)
    return_ = 300.0 + 20.0 * rollout.observation[..., 0]
    metrics = ppo.update_critic(rollout, return_, rng())
    assert metrics["ppo/grad_norm/critic"] > 0.1
    assert metrics["ppo/value_loss"] < 5.0


def test_the_critic_learns_returns_far_from_zero():
    ppo = make_ppo()
    generator = rng(1)
    metrics = {}
    for seed in range(60):
        rollout = make_rollout(ppo, seed)
        return_ = 300.0 + 20.0 * rollout.observation[..., 0] + 10.0 * rollout.privileged[..., 0]
        metrics = ppo.update_critic(rollout, return_, generator)
    assert metrics["ppo/explained_variance"] > 0.9


def left_and_right() -> Symmetry:
    """Of observation and action the first two numbers change places."""
    mirrors = (Mirror((1, 0, 2, 3, 4), (1.0,) * 5), Mirror((1, 0, 2), (1.0,) * 3))
    return Symmetry(*(Reflection([mirror], torch.device("cpu")) for mirror in mirrors))


def test_what_pays_on_one_side_is_learned_on_the_other_too():
    """Reward for a large first action where the first number is positive; nothing is ever said of the second action,
    which only the mirror tells about."""

    def moved(weight: float) -> tuple[float, float]:
        symmetry = left_and_right() if weight else None
        changes = {"minibatches": 1, "epochs": 4, "entropy_coef": 0.0, "desired_kl": 0.05, "symmetry_weight": weight}
        ppo = make_ppo(symmetry=symmetry, **changes)
        for seed in range(60):
            rollout = make_rollout(ppo, seed, envs=64)
            advantage = torch.where(rollout.observation[..., 0] > 1.0, rollout.action[..., 0], torch.zeros(()))
            ppo.update(rollout, advantage, rollout.value, rng(seed))
        first, second = torch.full((2, 5), 1.0)
        first[0] = second[1] = 3.0
        with torch.no_grad():
            return float(ppo.actor(first)[0]), float(ppo.actor(second)[1])

    first, second = moved(0.0)
    assert first > 0.3 and abs(second) < 0.3 * first
    first, second = moved(1.0)
    assert first > 0.3 and second == pytest.approx(first, rel=0.3)


def test_a_symmetric_policy_has_no_symmetry_loss():
    ppo = make_ppo(symmetry=left_and_right(), symmetry_weight=1.0)
    for layer in ppo.actor.network:
        if hasattr(layer, "weight"):
            layer.weight.data.zero_()
    ppo.actor.network[-1].bias.data[:] = torch.tensor([0.3, 0.3, -1.0])  # type: ignore[union-attr, operator]
    rollout = make_rollout(ppo, 0)
    rate = 1e-12
    ppo.config = replace(ppo.config, adaptive=False)
    ppo.actor_optimizer.param_groups[0]["lr"] = rate
    assert ppo.update(rollout, *advantage_of(rollout), rng())["ppo/symmetry_loss"] == pytest.approx(0.0, abs=1e-6)


def test_a_weight_without_a_symmetry_is_refused():
    with pytest.raises(ValueError, match="symmetry_weight"):
        make_ppo(symmetry_weight=1.0)
    with pytest.raises(ValueError, match="symmetry_weight"):
        make_ppo(symmetry=left_and_right())
