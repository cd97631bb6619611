"""Task rewards: one pure function per term, known by its name (docs/extending.md), and how they are mixed.

Penalties are positive numbers here; their weights are negative. `env.reward.terms` gives each term's weight, 0 by
default, and the values of its other parameters.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import torch
from torch import Tensor

from camp.common.bounds import Within, check_number
from camp.common.errors import ConfigError
from camp.envs.measurement import sliding_speed
from camp.envs.situation import Situation

Term = Callable[..., Tensor]  # (situation, parameters by name) -> (N,)
TERMS: dict[str, Term] = {}
WEIGHT = "weight"
_WEIGHT_RANGE = Within(-1e6, 1e6, "a weight beside others of order 1; penalties have negative ones")
_PARAMETER_RANGE = Within(1e-6, 1e6, "in SI units nothing of a robot is beyond")
# Metrics of the three rewards of eq. (2) have these names: `reward/style/raw`.
_TAKEN = ("task", "style", "skill")


def reward_term(function: Term) -> Term:
    """Make a function ``(situation, parameters) -> (N,)`` known as a reward term under its own name."""
    name = getattr(function, "__name__", "")
    if name in TERMS or name in _TAKEN:
        raise ValueError(f"reward term {name!r}: this name is taken; choose another one")
    TERMS[name] = function
    return function


@reward_term
def linear_velocity(s: Situation, width: float) -> Tensor:
    """Table II, first row, of the average velocity. width: m/s."""
    return linear_velocity_reward(s.command, s.average_velocity, width)


@reward_term
def angular_velocity(s: Situation, width: float) -> Tensor:
    """Table II, second row, of the average velocity. width: rad/s."""
    return angular_velocity_reward(s.command, s.average_velocity, width)


@reward_term
def torque(s: Situation) -> Tensor:
    """sum_j tau_j^2, (N m)^2, of the motors at the end of the step."""
    return s.torque.square().sum(dim=1)


@reward_term
def power(s: Situation) -> Tensor:
    """sum_j |tau_j q'_j|, W: mechanical power, also where a motor brakes."""
    return (s.torque * s.measurement.joint_velocity).abs().sum(dim=1)


@reward_term
def action_rate(s: Situation) -> Tensor:
    """sum_j (a_j - a_j before)^2, in squared action scales: how far the targets jump between two control steps."""
    return (s.last_action - s.before.action).square().sum(dim=1)


@reward_term
def joint_acceleration(s: Situation) -> Tensor:
    """sum_j q''_j^2, (rad/s^2)^2, from the joint velocities of two control steps."""
    return s.joint_acceleration.square().sum(dim=1)


@reward_term
def foot_slip(s: Situation) -> Tensor:
    """Sum over the feet in contact of v^2, (m/s)^2: how fast the point on the ground slides."""
    return (sliding_speed(s.setup.robot, s.measurement).square() * s.foot_contact).sum(dim=1)


@reward_term
def vertical_velocity(s: Situation) -> Tensor:
    """v_z^2 of the base, base frame, (m/s)^2."""
    return s.measurement.linear_velocity[:, 2].square()


@reward_term
def roll_pitch_rate(s: Situation) -> Tensor:
    """w_x^2 + w_y^2 of the base, base frame, (rad/s)^2."""
    return s.measurement.angular_velocity[:, :2].square().sum(dim=1)


@reward_term
def tilt(s: Situation) -> Tensor:
    """sin^2 of the angle between the trunk's and the world's vertical, in [0, 1]."""
    return s.measurement.gravity[:, :2].square().sum(dim=1)


def check_terms(terms: Mapping[str, Mapping[str, Any]]) -> None:
    """Raise ConfigError for a term or a parameter that does not exist, one that lacks and one out of range."""
    for name, values in terms.items():
        key = f"env.reward.terms.{name}"
        if name not in TERMS:
            raise ConfigError(f"{key}: no such reward term; choose from {', '.join(TERMS)}")
        known = _parameters(TERMS[name])
        wrong = next((given for given in values if given not in (WEIGHT, *known)), None)
        if wrong is not None:
            raise ConfigError(f"{key}.{wrong}: no such parameter; this term has {', '.join((WEIGHT, *known))}")
        lacking = [one for one, needed in known.items() if needed and one not in values]
        if lacking:
            raise ConfigError(f"{key}: lacks {lacking[0]}; add it beside {WEIGHT}")
        for parameter, value in values.items():
            check_number(f"{key}.{parameter}", value, _WEIGHT_RANGE if parameter == WEIGHT else _PARAMETER_RANGE)


def active_terms(terms: Mapping[str, Mapping[str, Any]]) -> dict[str, Callable[[Situation], Tensor]]:
    """By name what is computed at every step: the terms whose weight is not 0."""
    return {
        name: partial(TERMS[name], **{key: float(value) for key, value in values.items() if key != WEIGHT})
        for name, values in terms.items()
        if values.get(WEIGHT, 0.0) != 0.0
    }


def task_rewards(terms: Mapping[str, Callable[[Situation], Tensor]], situation: Situation) -> dict[str, Tensor]:
    """Every term by its name, unweighted, each (N,); 0 where a diverged simulation leaves no number."""
    return {name: term(situation).nan_to_num(0.0, 0.0, 0.0) for name, term in terms.items()}


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


def _parameters(term: Term) -> dict[str, bool]:
    """What a term asks for besides the situation, and whether it must be given."""
    parameters = list(inspect.signature(term).parameters.values())[1:]
    return {one.name: one.default is inspect.Parameter.empty for one in parameters}
