"""Task rewards of Table II: pure functions of velocities and commands."""

from __future__ import annotations

from torch import Tensor

from camp.envs.config import RewardConfig
from camp.envs.measurement import Measurement


def task_rewards(command: Tensor, measurement: Measurement, width: RewardConfig) -> dict[str, Tensor]:
    """Every task term by its name, unweighted, each (N,); 0 where the simulation diverged."""
    terms = {
        "linear_velocity": linear_velocity_reward(command, measurement.linear_velocity, width.linear_velocity_width),
        "angular_velocity": angular_velocity_reward(
            command, measurement.angular_velocity, width.angular_velocity_width
        ),
    }
    return {name: term.nan_to_num(0.0) for name, term in terms.items()}


def linear_velocity_reward(command: Tensor, velocity: Tensor, width: float) -> Tensor:
    """exp(-||v_xy^cmd - v_xy||_2 / width), (N,) in (0, 1]. Table II, first row (width 0.15 m/s).

    Args:
        command: (N, 3) vx, vy in m/s and yaw rate in rad/s, base frame.
        velocity: (N, 3) linear velocity of the base in m/s, base frame.
        width: m/s.
    """
    return (-(command[:, :2] - velocity[:, :2]).norm(dim=1) / width).exp()


def angular_velocity_reward(command: Tensor, angular_velocity: Tensor, width: float) -> Tensor:
    """exp(-|w_z^cmd - w_z| / width), (N,) in (0, 1]. Table II, second row (width 0.15 rad/s)."""
    return (-(command[:, 2] - angular_velocity[:, 2]).abs() / width).exp()
