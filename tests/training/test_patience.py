"""Robots that do not show their skill are given up after the configured time, and no others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
import torch

from camp.build import build_env, build_training
from camp.common.errors import ConfigError
from camp.data import Step
from camp.training.patience import Patience, build_patience
from tests.training.test_gait_monitor import step as made_up_step

NUM, PERIOD_S = 4, 0.02


class Reader:
    """Stands for the skill discriminator: a transition's only number is the label it shows."""

    embedding = SimpleNamespace(weight=torch.zeros(1))

    def predict(self, motion: Any) -> torch.Tensor:
        return motion.state

    def classify(self, predicted: torch.Tensor) -> torch.Tensor:
        return predicted.long()


def step(shown: list[int], skill: list[int], ended: list[bool] | None = None) -> Step:
    made = made_up_step(
        torch.zeros(NUM, 4, dtype=torch.bool), torch.tensor(skill), torch.tensor(ended or [False] * NUM)
    )
    made.transition = torch.tensor(shown)
    return made


def new(patience_s: float = 1.0) -> Patience:
    return Patience(Reader(), patience_s, NUM, PERIOD_S)  # type: ignore[arg-type]


def test_who_shows_another_skill_is_given_up_after_the_patience():
    patience, shown = new(), [0, 1, 0, 1]
    given_up = [patience.exhausted(step(shown, [0, 0, 1, 1])).tolist() for _ in range(50)]
    assert given_up[-2] == [False] * 4 and given_up[-1] == [False, True, True, False]


def test_a_lapse_or_showing_it_every_other_step_is_forgiven():
    patience = new()
    for t in range(500):
        lapse = 1 if 100 <= t < 130 else 0
        assert not patience.exhausted(step([lapse, t % 2, 0, 0], [0] * 4)).any()


def test_a_new_skill_and_a_new_episode_get_the_whole_patience():
    patience = new()
    for _ in range(40):
        patience.exhausted(step([1] * 4, [0] * 4))
    patience.exhausted(step([1] * 4, [0, 0, 2, 0], [True, False, False, False]))
    lost_after = torch.zeros(NUM)
    for t in range(60):
        lost = patience.exhausted(step([1] * 4, [0, 0, 2, 0]))
        lost_after[lost & (lost_after == 0)] = t + 1
    assert lost_after.tolist() == [50, 9, 49, 9]


def test_it_continues_from_its_state():
    straight, resumed = new(0.1), new(0.1)
    for t in range(4):
        straight.exhausted(step([1, t % 2, 0, 0], [0] * 4))
    resumed.load_state_dict(straight.state_dict())
    for _ in range(4):
        now = step([1, 1, 0, 1], [0] * 4)
        assert torch.equal(straight.exhausted(now), resumed.exhausted(now))


def test_giving_up_truncates_that_robots_episode_alone(config, clips):
    env = build_env(config, clips)
    env.reset(seed=0, options={"stagger": False})
    give_up = torch.arange(8) == 3
    result = env.advance(torch.zeros(8, 12), give_up)
    assert result.truncated.tolist() == give_up.tolist()
    assert (env.step_count == 0).tolist() == give_up.tolist()


def test_built_only_where_it_is_asked_for(config):
    assert build_patience(build_training(config), config) is None
    config.algo.skill.patience_s = 2.0
    assert build_patience(build_training(config), config) is not None


@pytest.mark.parametrize(("enabled", "patience_s"), [(False, 1.0), (True, 0.0)])
def test_patience_that_cannot_work_is_refused(config, enabled, patience_s):
    config.algo.skill.enabled, config.algo.skill.patience_s = enabled, patience_s
    with pytest.raises(ConfigError, match=r"algo\.skill\.patience_s"):
        config.check()
