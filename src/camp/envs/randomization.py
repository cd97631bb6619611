"""Domain randomization: the physical parameters of Table I."""

from __future__ import annotations

import torch

from camp.envs.commands import uniform
from camp.envs.config import RandomizationConfig
from camp.robots.quadruped import NUM_JOINTS
from camp.sim.base import LINK_NAMES, Dynamics


def sample_dynamics(num: int, config: RandomizationConfig, generator: torch.Generator) -> Dynamics:
    """Physical parameters of ``num`` robots, each uniform in its range of Table I; nominal where it is disabled."""
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
    )
