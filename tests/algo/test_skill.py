"""Skill prior: it recognizes synthetic skills and rewards motion that shows the commanded one."""

from __future__ import annotations

import copy

import torch

from camp.algo.skill import SkillPrior
from camp.data import Transition
from tests.algo.synthetic import SKILLS, STATE_SIZE, assert_identical, four_corners, make_skill, rng


def policy(seed: int = 50) -> Transition:
    """Trots whatever is commanded: three of four labels are wrong."""
    motion = four_corners().sample(256, rng(seed))
    trot = motion.state[motion.skill == 0].repeat(4, 1, 1)
    return Transition(trot, torch.arange(256) % 4)


def train(prior: SkillPrior, iterations: range) -> dict[str, float]:
    metrics: dict[str, float] = {}
    for i in iterations:
        metrics = prior.update(policy(seed=i), four_corners(), rng(1000 + i))
    return metrics


def test_classifies_four_clusters_and_rewards_the_commanded_one():
    prior = make_skill()
    metrics = train(prior, range(40))
    expert = four_corners().sample(400, rng(1))
    assert metrics["prior/skill/accuracy"] > 0.98
    assert all(metrics[f"prior/skill/accuracy/{skill}"] > 0.95 for skill in SKILLS)
    assert (prior.classify(prior.predict(expert)) == expert.skill).float().mean() > 0.98
    assert prior.reward(expert).mean() > 0.85
    wrong = Transition(expert.state, (expert.skill + 1) % 4)
    assert prior.reward(wrong).mean() < 0.4


def test_no_transitions_have_no_answers():
    prior, nothing = make_skill(), policy().take(slice(0, 0))
    assert prior.classify(prior.predict(nothing)).shape == (0,)
    assert prior.reward(nothing).shape == (0,)


def test_policy_accuracy_shows_which_skills_the_policy_performs():
    metrics = train(make_skill(), range(40))
    assert metrics["prior/skill/policy_accuracy/trot"] > 0.95
    assert metrics["prior/skill/policy_accuracy/pace"] < 0.05
    assert abs(metrics["prior/skill/policy_accuracy"] - 0.25) < 0.1


def test_the_loss_gives_the_embedding_no_gradient():
    prior = make_skill()
    before = prior.embedding.weight.detach().clone()
    train(prior, range(1))
    assert prior.embedding.weight.grad is None
    assert torch.equal(prior.embedding.weight, before)


def test_reward_is_bounded_and_carries_no_gradient():
    prior = make_skill()
    reward = prior.reward(policy())
    assert reward.shape == (256,) and not reward.requires_grad
    assert reward.abs().max() <= 1.0


def test_normalizer_sees_expert_states_only():
    prior = make_skill(batch_size=64)
    far = Transition(torch.full((512, 2, STATE_SIZE), 1000.0), torch.arange(512) % 4)
    prior.update(far, four_corners(), rng())
    assert prior.normalizer.count.item() == 2 * 64
    assert prior.normalizer.mean.abs().max() < 1.0


def test_penalty_limits_the_slope():
    loose, strict = make_skill(gradient_penalty=0.0), make_skill(gradient_penalty=1.0)
    slopes = [train(prior, range(20))["prior/skill/gradient_penalty"] for prior in (loose, strict)]
    assert slopes[1] < 0.7 * slopes[0]


def test_restored_prior_continues_bit_for_bit():
    prior = make_skill()
    train(prior, range(2))
    saved = copy.deepcopy(prior.state_dict())
    restored = make_skill(seed=9)
    restored.load_state_dict(saved)
    assert train(prior, range(2, 3)) == train(restored, range(2, 3))
    assert_identical(prior.state_dict(), restored.state_dict())
