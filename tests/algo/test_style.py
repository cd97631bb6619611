"""Style prior: it tells expert from policy, and with wrong labels shown, it listens to the condition."""

from __future__ import annotations

import copy

import pytest
import torch

from camp.algo.losses import style_reward
from camp.algo.models import SkillEmbedding
from camp.algo.style import StylePrior
from camp.common.errors import ConfigError
from camp.common.histogram import EDGES
from camp.data import Transition, concatenate
from tests.algo.synthetic import (
    SKILLS,
    STATE_SIZE,
    Blobs,
    assert_identical,
    four_corners,
    make_skill,
    make_style,
    rng,
    style_config,
)


def standing(n: int = 256, seed: int = 50) -> Transition:
    """A policy that stays at the origin whatever is commanded."""
    return Blobs(torch.zeros(4, 2, STATE_SIZE)).sample(n, rng(seed))


def train(prior: StylePrior, iterations: range) -> dict[str, float]:
    metrics: dict[str, float] = {}
    for i in iterations:
        metrics = prior.update(standing(seed=i), four_corners(), rng(1000 + i))
    return metrics


def test_separates_expert_from_policy():
    prior = make_style()
    before = prior.reward(four_corners().sample(256, rng(1))).mean() - prior.reward(standing()).mean()
    metrics = train(prior, range(30))
    expert, policy = prior.reward(four_corners().sample(256, rng(1))), prior.reward(standing())
    assert abs(before.item()) < 0.3
    assert expert.mean() > 0.9 and policy.mean() < 0.15
    assert metrics["prior/style/accuracy"] > 0.98
    assert all(metrics[f"prior/style/accuracy/{skill}"] > 0.95 for skill in SKILLS)
    assert metrics["prior/style/expert_logit"] > 0.7 and metrics["prior/style/policy_logit"] < -0.7


def test_histograms_tell_expert_from_policy_once_the_prior_does():
    prior = make_style()
    train(prior, range(30))
    before = copy.deepcopy(prior.state_dict())
    found = prior.histograms(standing(), four_corners(), rng(1))
    assert_identical(prior.state_dict(), before)
    expert, policy = (torch.tensor(found[f"prior/style/logit_histogram/{side}"]) for side in ("expert", "policy"))
    middle = torch.tensor(EDGES).unfold(0, 2, 1).mean(dim=1)
    assert expert @ middle == pytest.approx(prior.logit(four_corners().sample(64, rng(1))).mean().item(), abs=0.125)
    assert policy @ middle == pytest.approx(prior.logit(standing()).mean().item(), abs=0.125)
    assert expert[middle > 0].sum() > 0.95 and policy[middle < 0].sum() > 0.95


def wrong_label_gap(prior: StylePrior) -> float:
    """Mean logit of expert motion under its own label minus that under the next one."""
    expert = four_corners().sample(400, rng(3))
    wrong = Transition(expert.state, (expert.skill + 1) % 4)
    return (prior.logit(expert) - prior.logit(wrong)).mean().item()


def test_expert_motion_under_a_wrong_label_is_rejected_once_it_has_been_shown():
    shown, never = make_style(mismatch_fraction=0.5), make_style()
    for i in range(60):
        # A policy that performs every skill as commanded, but lifted along an axis that no expert uses: the
        # label is no help against it, so nothing forces D to listen to z. That is what the option is for.
        lifted = four_corners().sample(256, rng(i))
        lifted.state[..., 2] += 2.0
        for prior in (shown, never):
            prior.update(lifted, four_corners(), rng(1000 + i))
    assert wrong_label_gap(shown) > 1.0
    assert abs(wrong_label_gap(never)) < 0.3


def test_mislabelled_experts_never_keep_their_label():
    prior = make_style()
    expert = four_corners().sample(4000, rng())
    wrong = prior._mislabelled(expert, rng(1))
    assert (wrong.skill != expert.skill).all()
    assert torch.equal(wrong.state, expert.state)
    assert wrong.skill.bincount().min() > 800  # the other labels come up evenly


def test_without_conditioning_the_label_does_not_matter_and_the_embedding_stays():
    prior = make_style(conditional=False)
    embedding = prior.embedding.weight.detach().clone()
    train(prior, range(5))
    assert torch.equal(prior.embedding.weight, embedding)
    assert wrong_label_gap(prior) == 0.0


def test_the_embedding_learns_from_this_loss_and_not_from_the_skill_loss():
    style, skill = make_style(), make_skill()
    skill.embedding = style.embedding
    before = style.embedding.weight.detach().clone()
    skill.update(standing(), four_corners(), rng())
    assert torch.equal(style.embedding.weight, before) and style.embedding.weight.grad is None
    train(style, range(1))
    assert not torch.equal(style.embedding.weight, before)


def test_reward_is_equation_four_of_the_logit_and_carries_no_gradient():
    prior = make_style()
    reward = prior.reward(standing())
    assert reward.shape == (256,) and not reward.requires_grad
    torch.testing.assert_close(reward, style_reward(prior.logit(standing())))


def test_scoring_in_chunks_changes_nothing(monkeypatch: pytest.MonkeyPatch):
    prior = make_style()
    whole = prior.reward(standing())
    monkeypatch.setattr("camp.algo.prior.SCORE_CHUNK", 100)
    torch.testing.assert_close(prior.reward(standing()), whole)


def test_normalizer_is_fed_once_with_equal_parts_however_many_steps():
    prior = make_style(updates=7, batch_size=64)
    far = Transition(torch.full((512, 2, STATE_SIZE), 10.0), torch.arange(512) % 4)
    prior.update(far, Blobs(torch.zeros(4, 2, STATE_SIZE)), rng())
    assert prior.normalizer.count.item() == 2 * 2 * 64  # both frames of 64 expert and 64 policy transitions
    torch.testing.assert_close(prior.normalizer.mean, torch.full((STATE_SIZE,), 5.0).double(), atol=0.1, rtol=0)


def test_a_strong_penalty_flattens_the_discriminator_on_expert_motion():
    loose, strict = make_style(gradient_penalty=0.0), make_style(gradient_penalty=10.0)
    slopes = [train(prior, range(20))["prior/style/gradient_penalty"] for prior in (loose, strict)]
    assert slopes[1] < 0.3 * slopes[0]


def test_replay_keeps_half_of_the_fakes_from_the_past():
    prior = make_style(replay_size=1000, batch_size=64, updates=2)
    past = Transition(torch.full((256, 2, STATE_SIZE), -1.0), torch.zeros(256, dtype=torch.int64))
    now = Transition(torch.full((256, 2, STATE_SIZE), 1.0), torch.zeros(256, dtype=torch.int64))
    prior.update(past, four_corners(), rng())
    assert prior.replay is not None and len(prior.replay) == 128
    fakes = prior._fakes(now, four_corners(), rng())
    assert (fakes.state[:, 0, 0] == -1.0).sum() == (fakes.state[:, 0, 0] == 1.0).sum() == 32


def test_input_noise_reaches_both_sides():
    prior = make_style(input_noise=0.5)
    still = Transition(torch.zeros(5000, 2, STATE_SIZE), torch.zeros(5000, dtype=torch.int64))
    noisy = prior._noisy_input(still, rng())
    assert noisy.std().item() == pytest.approx(0.5, rel=0.03)


def test_restored_prior_continues_bit_for_bit():
    options = {"replay_size": 300, "input_noise": 0.1, "mismatch_fraction": 0.2}
    prior = make_style(**options)
    train(prior, range(2))
    saved, memory = copy.deepcopy(prior.state_dict()), copy.deepcopy(prior.memory())
    restored = make_style(seed=9, **options)
    restored.load_state_dict(saved)
    restored.load_memory(memory)
    assert train(prior, range(2, 3)) == train(restored, range(2, 3))
    assert_identical(prior.state_dict(), restored.state_dict())
    assert_identical(prior.memory(), restored.memory())


def test_mismatch_needs_a_second_skill():
    with pytest.raises(ConfigError, match="mismatch_fraction"):
        StylePrior(style_config(mismatch_fraction=0.5), SkillEmbedding(1, 8, rng()), ("trot",), STATE_SIZE, rng())


def test_embedding_similarity_is_the_largest_cosine_between_skills():
    prior = make_style()
    assert prior._embedding_similarity().item() == pytest.approx(0.0, abs=1e-5)
    with torch.no_grad():
        prior.embedding.weight[1] = 3.0 * prior.embedding.weight[0]
    assert prior._embedding_similarity().item() == pytest.approx(1.0)


def test_skills_absent_from_the_rollout_are_harmless():
    prior = make_style()
    only_trot = concatenate([standing(), standing()])
    only_trot.skill.zero_()
    metrics = prior.update(only_trot, four_corners(), rng())
    assert all(value == value for value in metrics.values())
