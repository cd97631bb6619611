"""Task rewards worked by hand, and the mix of all terms."""

from __future__ import annotations

import math

import pytest
import torch

from camp.envs.rewards import angular_velocity_reward, averaged, linear_velocity_reward, mix_rewards


def test_task_rewards_by_hand():
    command = torch.tensor([[0.5, 0.0, 0.3], [0.3, 0.4, 0.0]])
    velocity = torch.tensor([[0.5, 0.0, 9.0], [0.0, 0.0, 9.0]])  # errors 0 and .5 m/s; z does not count
    torch.testing.assert_close(
        linear_velocity_reward(command, velocity, 0.15), torch.tensor([1.0, math.exp(-0.5 / 0.15)])
    )
    for time_constant, fraction in ((0.0, 1.0), (0.02, 1.0), (0.1, 0.2)):
        average = averaged(torch.zeros(2, 3), velocity, 0.02, time_constant)
        torch.testing.assert_close(average, fraction * velocity)
    rate = torch.tensor([[9.0, 9.0, 0.0], [9.0, 9.0, 0.15]])  # errors .3 and .15 rad/s
    torch.testing.assert_close(
        angular_velocity_reward(command, rate, 0.15), torch.tensor([math.exp(-2.0), math.exp(-1.0)])
    )


def test_mix_is_the_weighted_sum_of_the_terms_present():
    terms = {
        "task": torch.tensor([1.0, 2.0]),
        "style": torch.tensor([0.5, 0.0]),
        "skill": torch.tensor([-1.0, 1.0]),
    }
    mixed = mix_rewards(terms, {"task": 1.0, "style": 2.0, "skill": 0.3, "unused": 9.0})
    torch.testing.assert_close(mixed, torch.tensor([1.7, 2.3]))


def test_mix_refuses_a_term_without_a_weight():
    with pytest.raises(KeyError):
        mix_rewards({"task": torch.tensor([1.0])}, {})
