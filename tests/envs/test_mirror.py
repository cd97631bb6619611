"""A robot and its mirror image: physics, observations and actions agree on what a mirror shows."""

from __future__ import annotations

from dataclasses import fields

import pytest
import torch

from camp.algo.mirror import Reflection
from camp.build import build_symmetry
from camp.common.errors import ConfigError
from camp.config.compose import compose_config
from camp.envs.measurement import measure
from camp.envs.observations import ENTRIES, Entry, entries_of, observation_entry, observe
from camp.envs.randomization import sample_dynamics
from camp.envs.situation import Before, Setup, Situation
from camp.robots import mirror
from camp.robots.go2 import GO2
from camp.robots.mirror import Mirror
from camp.sim.base import Dynamics, InitialState
from camp.sim.cpu import CpuSimulator

CPU = torch.device("cpu")
NAMES = tuple(ENTRIES)


def image(values: torch.Tensor, how: Mirror) -> torch.Tensor:
    return Reflection([how], CPU)(values)


def with_image(values: torch.Tensor, how: Mirror) -> torch.Tensor:
    """(1, size) -> (2, size), the second row as in a mirror."""
    return torch.cat([values, image(values, how)])


def two_robots(generator: torch.Generator) -> tuple[Dynamics, InitialState]:
    """One that is nowhere symmetric, with its feet near the ground, and its mirror image."""

    def some(size: int, spread: float, middle: torch.Tensor | float = 0.0) -> torch.Tensor:
        return middle + spread * (2.0 * torch.rand(1, size, generator=generator) - 1.0)

    ranges = compose_config([]).env.randomization
    one = sample_dynamics(1, ranges, generator)
    one.payload_position[:] = torch.tensor([0.03, 0.08, -0.05])
    how = {
        "link_mass_scale": mirror.LINKS,
        "payload_position": mirror.VECTOR,
        "motor_strength": mirror.JOINT_PROPERTIES,
        "kp_scale": mirror.JOINT_PROPERTIES,
        "kd_scale": mirror.JOINT_PROPERTIES,
    }
    both = {
        f.name: with_image(getattr(one, f.name), how[f.name]) if f.name in how else getattr(one, f.name).repeat(2)
        for f in fields(Dynamics)
    }
    quaternion = torch.nn.functional.normalize(torch.tensor([[1.0, 0.1, 0.05, 0.2]]))
    start = InitialState(
        base_position=with_image(torch.tensor([[0.0, 0.0, 0.29]]), mirror.VECTOR),
        base_quaternion=with_image(quaternion, mirror.QUATERNION),
        base_linear_velocity=with_image(some(3, 0.5), mirror.VECTOR),
        base_angular_velocity=with_image(some(3, 1.0), mirror.ROTATION),
        joint_position=with_image(some(12, 0.2, torch.tensor(GO2.default_joint_position)), mirror.JOINTS),
        joint_velocity=with_image(some(12, 2.0), mirror.JOINTS),
    )
    return Dynamics(**both), start


def test_after_mirrored_actions_a_mirrored_robot_observes_the_mirror_image():
    generator = torch.Generator().manual_seed(0)
    dynamics, start = two_robots(generator)
    sim = CpuSimulator(GO2, 2, 0.02, 0.005, threads=1)
    sim.prepare(dynamics)
    sim.reset(torch.ones(2, dtype=torch.bool), start)
    pose = torch.tensor(GO2.default_joint_position)
    for _ in range(5):
        action = with_image(torch.randn(1, 12, generator=generator), mirror.JOINTS)
        sim.step(pose + 0.25 * action)
    measurement = measure(GO2, sim.state)
    assert measurement.foot_contact.any(), "no foot has touched the ground: nothing is shown"
    velocity = with_image(torch.randn(1, 3, generator=generator), mirror.TWIST)
    situation = Situation(
        setup=Setup(GO2, 4, True, 0.25, 0.02),
        measurement=measurement,
        command=velocity,
        skill=torch.tensor([2, 2]),
        last_action=action,
        average_velocity=velocity,
        dynamics=dynamics,
        before=Before(action, measurement.joint_velocity),
    )
    entries = entries_of(NAMES, 4)
    seen = observe(entries, situation)
    assert not torch.allclose(seen[0], seen[1], atol=0.1)
    # The model's own inertia is not quite symmetric.
    own_parts, other_parts = (row.split([entry.size for entry in entries]) for row in seen)
    for entry, own, other in zip(entries, own_parts, other_parts, strict=True):
        torch.testing.assert_close(image(own, entry.known_mirror()), other, atol=0.01, rtol=0.01, msg=entry.name)


@pytest.mark.parametrize("entry", entries_of(NAMES, 4), ids=NAMES)
def test_mirroring_twice_changes_nothing(entry: Entry):
    values = torch.arange(1.0, entry.size + 1.0)
    torch.testing.assert_close(image(image(values, entry.known_mirror()), entry.known_mirror()), values)


def test_a_history_is_mirrored_frame_by_frame():
    config = compose_config(["env.observation.history=2", "env.observation.policy=[command,foot_contact]"])
    symmetry = build_symmetry(config, CPU)
    frame = [0.5, 0.1, -0.3, 1.0, 0.0, 1.0, 0.0]  # vx, vy, yaw rate; FL, FR, RL, RR
    other = [0.5, -0.1, 0.3, 0.0, 1.0, 0.0, 1.0]
    torch.testing.assert_close(symmetry.observation(torch.tensor(frame + other)), torch.tensor(other + frame))
    action = torch.arange(1.0, 13.0)  # FL, FR, RL, RR with hip, thigh and calf
    swapped = torch.tensor([-4.0, 5.0, 6.0, -1.0, 2.0, 3.0, -10.0, 11.0, 12.0, -7.0, 8.0, 9.0])
    torch.testing.assert_close(symmetry.action(action), swapped)


def test_an_entry_without_a_mirror_image_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("camp.envs.observations.ENTRIES", dict(ENTRIES))

    @observation_entry(12, "N m", "joint")
    def joint_torque(s: Situation) -> torch.Tensor:
        return s.torque

    config = compose_config([])
    config.env.observation.policy = ["joint_torque"]
    with pytest.raises(
        ConfigError, match=r"'joint_torque' beside algo.ppo.symmetry_weight > 0.*@observation_entry a mirror"
    ):
        build_symmetry(config, CPU)
