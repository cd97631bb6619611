"""Every number of the schema has finite bounds with a reason, and none beyond them is let through."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import is_dataclass
from functools import cache
from math import inf, isfinite, nan
from typing import Any, get_args, get_origin, get_type_hints

import pytest
from hydra import compose, initialize_config_dir

from camp.common.bounds import bounds_of, check_numbers
from camp.common.errors import ConfigError
from camp.common.paths import config_root
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.evaluation.config import EvaluationConfig, resolve_evaluation

SCHEMAS = {"train": Config, "evaluate": EvaluationConfig}


def numbers(schema: type, key: str = "") -> Iterator[tuple[str, Any]]:
    """Every field below ``schema`` that is or lists numbers, by its key, with its declared type."""
    plain, declared = get_type_hints(schema), get_type_hints(schema, include_extras=True)
    for name, hint in plain.items():
        path = f"{key}.{name}" if key else name
        if is_dataclass(hint):
            yield from numbers(hint, path)
        elif {int, float} & {hint, *get_args(hint)}:
            yield path, declared[name]


FIELDS = [(name, key, hint) for name, schema in SCHEMAS.items() for key, hint in numbers(schema)]


@cache
def shipped(name: str) -> Any:
    """conf/<name>.yaml, typed."""
    if name == "train":
        return compose_config(["run=smoke", "sim=gpu", "sim.device=cpu"])
    with initialize_config_dir(str(config_root() / "evaluation"), version_base="1.3"):
        return resolve_evaluation(compose("evaluate", overrides=["run=none"]))


def test_the_walk_meets_every_number():
    assert len(FIELDS) > 130
    keys = {key for name, key, _ in FIELDS if name == "train"}
    assert {"seed", "sim.threads", "env.command.vx_m_s", "algo.style.hidden", "algo.skill.patience_s"} <= keys


@pytest.mark.parametrize(("name", "key", "hint"), FIELDS, ids=[f"{name}:{key}" for name, key, _ in FIELDS])
def test_a_number_has_bounds_with_a_reason_and_stays_within(name, key, hint):
    within = bounds_of(hint)
    assert isfinite(within.low) and isfinite(within.high) and within.low < within.high and len(within.reason) > 4
    config = copy.deepcopy(shipped(name))
    check_numbers("", config)
    *groups, field = key.split(".")
    place = config
    for group in groups:
        place = getattr(place, group)
    for wrong in (within.low - 1, 2 * within.high + 1, nan, inf, -inf, 1e300, True, "1", [1.0], None):
        if wrong is None and type(None) in get_args(hint):
            continue
        listed = get_origin(hint) is list
        setattr(place, field, [wrong] if listed else wrong)
        with pytest.raises(ConfigError) as caught:
            check_numbers("", config)
        line = str(caught.value)
        assert line.startswith(f"{key} = ") and " from " in line and within.reason in line and "\n" not in line


def test_a_number_without_bounds_is_found():
    with pytest.raises(KeyError):
        bounds_of(list[float])


@pytest.mark.parametrize(
    "override",
    [
        "robot.kp=[[30],[30],[40]]",
        "env.randomization.friction=[[0.5],[1.0]]",
        "env.command.vx_m_s=[[-0.4],[0.9]]",
        "motion.frequencies_hz=[[2.0]]",
        "algo.actor.hidden=[[512]]",
        "env.transition_ages=[[1],[0]]",
        "env.episode_s=inf",
        "robot.kp=[1e300,30,40]",
        "sim.num_envs=1000000000000",
        "sim.threads=100000",
        "algo.actor.hidden=[1000000]",
        "sim.physics_timestep_s=1e-300",
        "env.randomization.payload_mass_kg=[0,1e300]",
    ],
)
def test_absurd_values_are_one_line(override):
    with pytest.raises(ConfigError) as caught:
        compose_config([override])
    assert override.partition("=")[0] in str(caught.value) and "\n" not in str(caught.value)
