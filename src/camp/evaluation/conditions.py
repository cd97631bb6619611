"""The disturbances that robots are measured under, as conf/evaluation lists them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self, get_type_hints

import torch

from camp.common import checks
from camp.common.bounds import Kick, Within, bounds_of, check_number
from camp.envs.config import RandomizationConfig
from camp.sim.base import Dynamics

# Key of a condition -> field of Dynamics, filled with the value for every link, joint or axis.
DYNAMICS_KEYS = {
    "link_mass_scale": "link_mass_scale",
    "payload_mass_kg": "payload_mass",
    "payload_position_m": "payload_position",
    "friction": "friction",
    "motor_strength_scale": "motor_strength",
    "kp_scale": "kp_scale",
    "kd_scale": "kd_scale",
    "delay_s": "delay",
}
_ABOUT_ONE = ("link_mass_scale", "motor_strength_scale", "kp_scale", "kd_scale")
_DISTURBANCES = ("noise", "push_m_s", "loss")
_DRAWN = get_type_hints(RandomizationConfig, include_extras=True)
_BOUNDS = {key: bounds_of(_DRAWN[key]) for key in DYNAMICS_KEYS} | {
    "noise": Within(0.0, 100.0, "times the suite's sensor noise"),
    "push_m_s": bounds_of(Kick),
    "loss": Within(0.0, 0.99, "a fraction; some targets must arrive"),
}


@dataclass(frozen=True)
class Condition:
    """A robot that differs from the nominal one, or what befalls it."""

    name: str
    values: dict[str, float]  # keys of DYNAMICS_KEYS
    noise: float = 0.0  # times the suite's sensor noise
    push_m_s: float = 0.0  # sudden change of the base's horizontal velocity
    loss: float = 0.0  # fraction of the joint targets that never arrive: the motors go on with the one before

    @classmethod
    def of(cls, entry: dict[str, Any]) -> Self:
        """From an entry that `check_conditions` has let through."""
        values = {key: float(entry[key]) for key in DYNAMICS_KEYS if key in entry}
        return cls(str(entry["name"]), values, **{key: float(entry[key]) for key in _DISTURBANCES if key in entry})

    def dynamics(self, num: int, friction: float) -> Dynamics:
        """``num`` robots under this condition; ``friction`` where the condition says nothing about it."""
        result = Dynamics.nominal(num, friction, torch.device("cpu"))
        for key, value in self.values.items():
            result.tensors()[DYNAMICS_KEYS[key]].fill_(value)
        return result


def check_conditions(key: str, entries: Sequence[Any]) -> None:
    """Raise ConfigError for the first entry that is no condition; ``key`` is where they stand."""
    seen: dict[str, str] = {}
    for entry in entries:
        named = isinstance(entry, dict) and isinstance(entry.get("name"), str)
        checks.require(named, key, entry, "give {name: ..., and what differs}")
        name = entry["name"]
        checks.require(name not in seen, key, name, "name each condition once")
        for what, value in entry.items():
            if what != "name":
                _check_value(f"{key}[{name}].{what}", what, value)
        same = [other for other, text in seen.items() if text == _content(entry)]
        checks.require(not same, key, name, f"is the same as {', '.join(same)}: measure each condition once")
        seen[name] = _content(entry)


def _content(entry: dict[str, Any]) -> str:
    """What differs, as text; values that are nothing (a payload of 0 kg) left out."""
    nothing = {"payload_mass_kg": 0.0, "noise": 0.0, "push_m_s": 0.0, "delay_s": 0.0, "loss": 0.0}
    neutral = nothing | dict.fromkeys(_ABOUT_ONE, 1.0)
    return str(sorted((k, float(v)) for k, v in entry.items() if k != "name" and float(v) != neutral.get(k)))


def _check_value(key: str, what: str, value: Any) -> None:
    known = (*DYNAMICS_KEYS, *_DISTURBANCES)
    checks.require(what in known, key, value, f"unknown; choose from {', '.join(known)}")
    check_number(key, value, _BOUNDS[what])
