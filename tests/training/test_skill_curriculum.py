"""Episode lengths and shares of time by success: what is counted, which way it moves, and what the environment does."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
import torch

from camp.build import build_env, build_training
from camp.common.errors import ConfigError
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.envs.skill_schedule import SkillSchedule
from camp.training.skill_curriculum import (
    SHRINKING,
    SkillCurriculum,
    _balanced,
    _shares,
    build_skill_curriculum,
)

SKILLS = ("trot", "pace", "bound", "pronk")


class Reader:
    """Stands for the skill discriminator: a transition's only number is the label it shows."""

    embedding = SimpleNamespace(weight=torch.zeros(1))

    def predict(self, motion: Any) -> torch.Tensor:
        return motion.state

    def classify(self, predicted: torch.Tensor) -> torch.Tensor:
        return predicted.long()


@pytest.fixture
def curriculum(config: Config) -> SkillCurriculum:
    config.env.episode_growth.initial_s = config.env.episode_growth.by_skill_from_s = 0.4
    config.env.episode_s, config.env.command.skill_focus = 1.0, 0.0
    env = SimpleNamespace(sim=SimpleNamespace(device=torch.device("cpu")), skill_schedule=None)
    return SkillCurriculum(Reader(), SimpleNamespace(env=env), config)  # type: ignore[arg-type]


def rollout(skill: list[list[int]], shown: list[list[int]], **ends: list[tuple[int, int]]) -> Any:
    """Columns are robots, rows steps; terminated, truncated: (step, robot) pairs."""
    made = SimpleNamespace(skill=torch.tensor(skill), transition=torch.tensor(shown))
    for name in ("terminated", "truncated"):
        flags = torch.zeros_like(made.skill, dtype=torch.bool)
        for step, robot in ends.get(name, []):
            flags[step, robot] = True
        setattr(made, name, flags)
    return made


def test_stretches_end_by_time_out_fall_or_new_skill(curriculum):
    skill = [[0, 1, 2, 3], [0, 1, 2, 3], [0, 1, 3, 3]]
    shown = [[0, 1, 2, 0], [0, 1, 2, 0], [1, 1, 3, 0]]
    seen = rollout(skill, shown, terminated=[(1, 1)], truncated=[(1, 0), (2, 3)])
    ended, success = curriculum._count(seen)
    # Trot timed out while shown, pace fell while shown, bound was followed by pronk, one pronk timed out as a trot.
    assert ended.tolist() == [1, 1, 1, 1] and success.tolist() == [1, 0, 1, 0]
    assert not seen.truncated[1, 2], "the rollout must stay as it was"


def test_episodes_grow_with_success_and_shrink_without(curriculum):
    env = curriculum._env
    env.skill_schedule.episode_s = torch.tensor([0.6, 0.6, 0.6, 0.4])
    seen = rollout([[0, 1, 2, 3]], [[0, 0, 2, 0]], truncated=[(0, 0), (0, 1), (0, 3)])
    metrics = curriculum.update(seen)
    doublings = curriculum._doublings
    expected = torch.tensor([0.6 * 2**doublings, 0.6 * 2 ** (-SHRINKING * doublings), 0.6, 0.4])
    expected[2] = 0.6 * 2 ** (-SHRINKING * doublings)  # no stretch has ever ended: nothing is known to succeed
    torch.testing.assert_close(env.skill_schedule.episode_s, expected.clamp(0.4, 1.0))
    assert metrics["curriculum/success/trot"] == 1.0 and metrics["curriculum/success/pace"] == 0.0
    assert metrics["curriculum/time_fraction/bound"] == 0.25
    for _ in range(200):
        curriculum.update(seen)
    assert env.skill_schedule.episode_s.tolist() == pytest.approx([1.0, 0.4, 0.4, 0.4])


def test_until_then_all_episodes_grow_alike(curriculum):
    growth, env = curriculum._growth, curriculum._env
    growth.by_skill_from_s = 0.5
    lost = rollout([[0, 1, 2, 3]], [[1, 0, 0, 0]], truncated=[(0, 0), (0, 1), (0, 2), (0, 3)])
    while env.skill_schedule.episode_s.max() < 0.5:
        before = env.skill_schedule.episode_s.clone()
        curriculum.update(lost)
        torch.testing.assert_close(env.skill_schedule.episode_s, before * 2**curriculum._doublings)
    curriculum.update(lost)
    assert (env.skill_schedule.episode_s < before).all()
    for _ in range(100):
        curriculum.update(lost)
    assert env.skill_schedule.episode_s.tolist() == pytest.approx([0.4] * 4)


def test_time_is_wanted_equally_or_by_failure():
    success = torch.tensor([0.0, 0.5, 1.0, 1.0])
    assert _shares(success, 0.0).tolist() == [0.25] * 4
    by_failure = _shares(success, 1.0)
    assert by_failure.sum() == pytest.approx(1.0) and by_failure[0] == pytest.approx(2.0 * by_failure[1].item())
    assert by_failure[2] < 0.01


def test_draws_are_balanced_until_time_is_as_wanted():
    """One skill's episodes are ten times as short: drawn alike, it would get a tenth of the others' time."""
    duration, wanted = torch.tensor([0.4, 4.0, 4.0, 4.0]), torch.tensor([0.4, 0.2, 0.2, 0.2])
    weight = torch.ones(4)
    for _ in range(100):
        share = weight * duration / (weight * duration).sum()
        weight = _balanced(weight, wanted, share)
    torch.testing.assert_close(weight * duration / (weight * duration).sum(), wanted, atol=0.02, rtol=0.0)
    assert weight.mean() == pytest.approx(1.0)


def test_a_schedule_draws_by_weight_and_measures_in_steps():
    schedule = SkillSchedule(torch.tensor([0.4, 0.001, 1.0]), torch.tensor([1.0, 3.0, 0.0]))
    drawn = schedule.draw(4000, torch.Generator().manual_seed(0)).bincount(minlength=3) / 4000
    torch.testing.assert_close(drawn, torch.tensor([0.25, 0.75, 0.0]), atol=0.03, rtol=0.0)
    assert schedule.episode_steps(torch.tensor([2, 0, 1]), 0.02).tolist() == [50, 20, 1]


def test_the_environment_truncates_each_skill_at_its_own_time(config, clips):
    config.env.episode_growth.initial_s = config.env.episode_growth.by_skill_from_s = 0.2
    env = build_env(config, clips)
    env.skill_schedule = SkillSchedule.uniform(4, 0.2, env.sim.device)
    env.skill_schedule.episode_s[1] = 0.1
    env.reset(seed=0, options={"stagger": False})
    begun = env.skill.clone()
    assert {1} < set(begun.tolist())
    first_end = torch.zeros(8, dtype=torch.int64)
    for step in range(1, 11):
        ended = env.advance(torch.zeros(8, 12)).truncated
        first_end[ended & (first_end == 0)] = step
    upright = first_end > 0
    assert upright.any()
    assert (first_end == torch.where(begun == 1, 5, 10))[upright].all()


def test_a_robot_does_not_change_to_a_skill_whose_episodes_would_be_over(config, clips):
    config.env.episode_growth.initial_s = config.env.episode_growth.by_skill_from_s = 0.06
    config.env.command.skill_period_s = 0.1
    env = build_env(config, clips)
    env.skill_schedule = SkillSchedule.uniform(4, 0.3, env.sim.device)
    env.skill_schedule.episode_s[1] = 0.06
    env.reset(seed=0, options={"stagger": False})
    began, changed = 0, 0
    for _ in range(30):
        before, lasted = env.skill.clone(), env.step_count + 1
        step = env.advance(torch.zeros(8, 12))
        ended = step.terminated | step.truncated
        assert not (~ended & (before != 1) & (env.skill == 1)).any()
        began += int((ended & (env.skill == 1)).sum())
        changed += int((~ended & (env.skill != before)).sum())
        assert (step.truncated & (before != 1) & (lasted % 5 > 0)).sum() == 0  # no change was stopped half-way
    assert began > 0
    assert changed > 0


def test_a_schedule_draws_among_what_is_possible_for_each_robot():
    schedule = SkillSchedule(torch.ones(3), torch.tensor([1.0, 100.0, 3.0]))
    possible = torch.tensor([[True, False, True], [False, False, True]]).repeat(2000, 1)
    drawn = schedule.draw_among(possible, torch.Generator().manual_seed(0)).view(2000, 2)
    assert (drawn[:, 1] == 2).all()
    shares = drawn[:, 0].bincount(minlength=3) / 2000
    torch.testing.assert_close(shares, torch.tensor([0.25, 0.0, 0.75]), atol=0.04, rtol=0.0)


def test_nothing_is_built_where_all_skills_are_alike(config):
    assert build_skill_curriculum(build_training(config), config) is None
    config.env.command.skill_focus = 0.5
    assert build_skill_curriculum(build_training(config), config) is not None


@pytest.mark.parametrize(
    ("overrides", "key"),
    [
        (["env.episode_growth.by_skill_from_s=1"], r"env\.episode_growth\.by_skill_from_s"),
        (["env.command.skill_focus=1.5"], r"env\.command\.skill_focus"),
        (["env.command.skill_focus=0.5", "algo.skill.enabled=false"], r"env\.command\.skill_focus"),
        (["env.episode_growth.success_down=0.9"], r"env\.episode_growth\.success_down"),
    ],
)
def test_values_that_cannot_work_are_refused(overrides, key):
    with pytest.raises(ConfigError, match=key):
        compose_config(["run=smoke", "sim=cpu", *overrides])
