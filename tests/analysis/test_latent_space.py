"""The paper's claims about distances, and priors that learn from the expert alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from analysis import expert_priors
from analysis.dtw import LatentDistances
from analysis.incentive import PRESET, margin, reward_matrix
from analysis.latent_space import claims
from camp.algo.skill import SkillPrior
from camp.build import motion_folder
from camp.config.compose import compose_config
from camp.motion.clips.store import load_clip

LABELS = ["trot_2hz", "trot_4hz", "bound_2hz", "bound_4hz", "pronk_2hz"]
COMMANDS = ("in_place", "forward_0.3", "forward_0.6", "forward_0.8", "left_0.25")


def distances(within: float, pronk_bound: float) -> LatentDistances:
    gait = np.array([label.split("_")[0] for label in LABELS])
    distance = np.where(gait[:, None] == gait[None, :], within, 50.0)
    np.fill_diagonal(distance, 0.0)
    i, j = LABELS.index("pronk_2hz"), LABELS.index("bound_2hz")
    distance[i, j] = distance[j, i] = pronk_bound
    return LatentDistances(LABELS, distance)


@pytest.mark.parametrize(
    ("within", "pronk_bound", "hold"),
    [(3.2, 40.0, [True, False]), (60.0, 40.0, [False, True]), (10.0, 8.0, [False, True])],
)
def test_claims_hold_or_do_not(within, pronk_bound, hold):
    found = claims(distances(within, pronk_bound))
    assert [claim.holds for claim in found] == hold
    assert str(found[0]).startswith("holds" if hold[0] else "does not hold")
    assert f"trot_2hz-trot_4hz {within:.1f}" in found[0].figures
    assert found[1].figures == f"pronk_2hz-bound_2hz {pronk_bound:.1f}, bound_2hz-bound_4hz {within:.1f}"


@pytest.fixture(scope="module")
def config():
    return compose_config(
        [
            *PRESET,
            *("motion.skills=[trot,pronk]", "motion.frequencies_hz=[3.0]", "motion.num_preloaded=2000"),
            *(f"algo.{prior}.{value}" for prior in ("style", "skill") for value in ("hidden=[32]", "batch_size=128")),
        ]
    )


@pytest.fixture(scope="module")
def clips(config):
    folder = motion_folder(config)
    return [load_clip(folder / f"{gait}_3hz_{name}.npz") for gait in ("trot", "pronk") for name in COMMANDS]


def test_the_same_commands_are_held_out_of_every_gait(clips):
    learned, asked = expert_priors.split_commands([*clips, replace(clips[0], split="varied")])
    assert [clip.gait for clip in asked] == ["trot", "trot", "pronk", "pronk"]
    assert {tuple(c.command) for c in asked}.isdisjoint(tuple(c.command) for c in learned if c.is_steady)
    assert len(learned) + len(asked) == 11


def test_a_prior_that_knows_the_labels_pays_for_obedience(config, clips):
    shown = expert_priors.show(config, clips)
    priors = expert_priors.fresh_priors(config)
    fakes = expert_priors.make_fakes("blind", shown, shown.asked)
    drawn = fakes(400, torch.Generator().manual_seed(0))
    assert drawn.state.shape == (400, 3, 43) and 100 < int(drawn.skill.sum()) < 300
    expert_priors.train(priors, shown, fakes, iterations=80, seed=0)
    found = {prior.name: margin(reward_matrix(prior, shown.asked, 2)) for prior in priors}
    assert found["style"].mean > 0.05 and found["skill"].mean > 0.05


def test_a_prior_without_labels_pays_the_same_whatever_is_commanded(config, clips):
    plain = compose_config(["run=scratch", "+ablation=neither_conditional"]).algo.style
    own = replace(config, algo=replace(config.algo, style=replace(plain, hidden=[8], batch_size=64)))
    own.algo = replace(own.algo, skill=replace(own.algo.skill, enabled=False))
    shown, (prior,) = expert_priors.show(own, clips), expert_priors.fresh_priors(own)
    expert_priors.train([prior], shown, expert_priors.make_fakes("blind", shown, shown.asked), 2, seed=0)
    reward = reward_matrix(prior, shown.asked, 2)
    np.testing.assert_allclose(reward[:, 0], reward[:, 1])
    assert margin(reward).mean == pytest.approx(0.0, abs=1e-6)


def test_convergence_ends_where_held_out_motion_is_known(config, clips):
    shown = expert_priors.show(config, clips)
    prior = next(one for one in expert_priors.fresh_priors(config) if isinstance(one, SkillPrior))
    losses = expert_priors.converge(prior, shown, seed=0, least_gain=0.5)
    assert expert_priors.PATIENCE < len(losses) < expert_priors.MOST_BLOCKS
    before, last = losses[: -expert_priors.PATIENCE], losses[-expert_priors.PATIENCE :]
    assert min(last) >= 0.5 * min(before)
