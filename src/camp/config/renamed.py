"""Renamed configuration keys: old command lines and run folders keep working."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from omegaconf import DictConfig, OmegaConf

RENAMED = {
    "algo.ppo.discount": "algo.ppo.gamma",
    "algo.ppo.trace": "algo.ppo.gae_lambda",
    "algo.ppo.clip": "algo.ppo.clip_param",
    "algo.ppo.value_clip": "algo.ppo.value_clip_param",
    "algo.ppo.entropy": "algo.ppo.entropy_coef",
    "algo.style.mismatch_share": "algo.style.mismatch_fraction",
    "env.command.zero_component_share": "env.command.zero_component_fraction",
    "env.command.zero_share": "env.command.zero_fraction",
    "env.initialization.reference_share": "env.initialization.reference_fraction",
    "env.reward.linear_velocity_weight": "env.reward.terms.linear_velocity.weight",
    "env.reward.linear_velocity_width": "env.reward.terms.linear_velocity.width",
    "env.reward.angular_velocity_weight": "env.reward.terms.angular_velocity.weight",
    "env.reward.angular_velocity_width": "env.reward.terms.angular_velocity.width",
}


def with_new_names(config: DictConfig) -> DictConfig:
    """A configuration in which every old name has become the new one; where both are given, the new one counts."""
    values = OmegaConf.to_container(config, resolve=False)
    for old, new in RENAMED.items():
        *groups, key = old.split(".")
        place: Any = values
        for group in groups:
            place = place.get(group) if isinstance(place, dict) else None
        if isinstance(place, dict) and key in place:
            _set_default(values, new, place.pop(key))
    return cast(DictConfig, OmegaConf.create(values))


def _set_default(values: Any, key: str, value: Any) -> None:
    """Give a dotted key a value where it has none, making the groups on the way."""
    *groups, name = key.split(".")
    for group in groups:
        values = values.setdefault(group, {})
        if not isinstance(values, dict):  # the schema says what is wrong with it
            return
    values.setdefault(name, value)


def renamed_overrides(overrides: Sequence[str]) -> list[str]:
    """Command-line overrides such as ``algo.ppo.clip=0.1`` under their new names."""
    return [_renamed_override(override) for override in overrides]


def _renamed_override(override: str) -> str:
    key, equals, value = override.partition("=")
    name = key.lstrip("+~")
    return key.removesuffix(name) + RENAMED.get(name, name) + equals + value
