"""Domain randomization: the physical parameters of Table I, and how far its ranges reach."""

from __future__ import annotations

from dataclasses import replace

import torch

from camp.envs.commands import uniform
from camp.envs.config import RandomizationConfig
from camp.robots.quadruped import NUM_JOINTS
from camp.sim.base import LINK_NAMES, Dynamics

_ABOUT_ONE = ("link_mass_scale", "motor_strength_scale", "kp_scale", "kd_scale")
_ABOUT_ZERO = ("payload_mass_kg", "payload_position_m", "delay_s")


def sample_dynamics(num: int, config: RandomizationConfig, generator: torch.Generator) -> Dynamics:
    """Physical parameters of ``num`` robots, each uniform in its range; nominal where it is disabled."""
    if not config.enabled:
        return Dynamics.nominal(num, config.nominal_friction, generator.device)
    return Dynamics(
        link_mass_scale=uniform(config.link_mass_scale, (num, len(LINK_NAMES)), generator),
        payload_mass=uniform(config.payload_mass_kg, (num,), generator),
        payload_position=uniform(config.payload_position_m, (num, 3), generator),
        friction=uniform(config.friction, (num,), generator),
        motor_strength=uniform(config.motor_strength_scale, (num, NUM_JOINTS), generator),
        kp_scale=uniform(config.kp_scale, (num, NUM_JOINTS), generator),
        kd_scale=uniform(config.kd_scale, (num, NUM_JOINTS), generator),
        delay=sample_delays(num, config, generator),
    )


def sample_delays(num: int, config: RandomizationConfig, generator: torch.Generator) -> torch.Tensor:
    """(num,) s; nothing is drawn where there are none, so that Table I alone gives the same robots as ever."""
    if not config.enabled or config.delay_s[1] == 0.0:
        return torch.zeros(num, device=generator.device)
    return uniform(config.delay_s, (num,), generator)


def randomization_at(difficulty: float, config: RandomizationConfig) -> RandomizationConfig:
    """The ranges at a difficulty in [0, 1]: each end at that share of its way from the nominal robot."""
    if difficulty == 1.0:
        return config
    narrowed = {name: _towards(1.0, getattr(config, name), difficulty) for name in _ABOUT_ONE}
    narrowed |= {name: _towards(0.0, getattr(config, name), difficulty) for name in _ABOUT_ZERO}
    narrowed["friction"] = _towards(config.nominal_friction, config.friction, difficulty)
    return replace(config, **narrowed)


def _towards(nominal: float, bounds: list[float], difficulty: float) -> list[float]:
    return [nominal + difficulty * (bound - nominal) for bound in bounds]
