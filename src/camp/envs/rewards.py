"""Task rewards of Table II: pure functions of velocities and commands."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from camp.envs.config import RewardConfig


def task_rewards(command: Tensor, velocity: Tensor, width: RewardConfig) -> dict[str, Tensor]:
    """Every task term by its name, unweighted, each (N,), for a velocity (N, 3) as commands are given."""
    return {
        "linear_velocity": linear_velocity_reward(command, velocity, width.linear_velocity_width),
        "angular_velocity": angular_velocity_reward(command, velocity, width.angular_velocity_width),
    }


def averaged(average: Tensor, velocity: Tensor, period: float, time_constant: float) -> Tensor:
    """The exponential average (N, 3) after another control step of `period` s.

    A body sways at every stride: the expert's pace at 2 Hz by .3 m/s sideways, so that an exact pace would be paid
    no more than standing still. The average over about a stride is what a command can mean. time_constant: s; up to
    a period the velocity itself, as in Table II.
    """
    return average + min(1.0, period / max(time_constant, period)) * (velocity - average)


def linear_velocity_reward(command: Tensor, velocity: Tensor, width: float) -> Tensor:
    """exp(-||v_xy^cmd - v_xy||_2 / width), (N,) in (0, 1]. Table II, first row (width 0.15 m/s).

    Args:
        command: (N, 3) vx, vy in m/s and yaw rate in rad/s, base frame.
        velocity: (N, 3) the same of the base.
        width: m/s.
    """
    return (-(command[:, :2] - velocity[:, :2]).norm(dim=1) / width).exp()


def angular_velocity_reward(command: Tensor, velocity: Tensor, width: float) -> Tensor:
    """exp(-|w_z^cmd - w_z| / width), (N,) in (0, 1]. Table II, second row (width 0.15 rad/s)."""
    return (-(command[:, 2] - velocity[:, 2]).abs() / width).exp()


def mix_rewards(terms: Mapping[str, Tensor], weights: Mapping[str, float]) -> Tensor:
    """r = sum_i w_i r_i over the terms present, eq. (2). Raises KeyError where a term has no weight."""
    total = [weights[name] * term for name, term in terms.items()]
    return torch.stack(total).sum(dim=0)
