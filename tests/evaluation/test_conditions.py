"""Robots under trouble: what a condition changes, and what it is refused for."""

from __future__ import annotations

import pytest
import torch

from camp.common.errors import ConfigError
from camp.evaluation.conditions import Condition, check_conditions
from camp.evaluation.plan import disturbed_plan, grid_plan, one_per_gait, switching_plan
from camp.evaluation.rollout import roll_out
from camp.gaits.skills import skill_set


def test_conditions_become_robots_one_after_the_other():
    grid = grid_plan(2, [[0.5, 0.0, 0.0], [0.0, 0.0, 0.6], [0.0, 0.0, 0.0]], 10, 0.8)
    conditions = [
        Condition.of(entry)
        for entry in (
            {"name": "nominal"},
            {"name": "loaded", "payload_mass_kg": 3, "payload_position_m": -0.1},
            {"name": "noisy", "noise": 1.0, "push_m_s": 0.5, "kp_scale": 0.8},
        )
    ]
    plan = disturbed_plan(grid, conditions, 0.8, 2.5)
    assert len(plan) == 18 and plan.skill[:6, 0].tolist() == [0, 0, 0, 1, 1, 1]
    assert plan.dynamics.payload_mass.tolist() == [0.0] * 6 + [3.0] * 6 + [0.0] * 6
    assert plan.dynamics.payload_position[6].tolist() == pytest.approx([-0.1] * 3)
    assert plan.dynamics.kp_scale[12:].unique().tolist() == pytest.approx([0.8])
    assert plan.dynamics.friction.unique().tolist() == pytest.approx([0.8])
    assert plan.noise.tolist() == [0.0] * 12 + [1.0] * 6 and plan.push_m_s[-1] == 0.5


def test_sequences_of_one_skill_of_each_gait():
    skills = skill_set(("trot", "bound"), "gait_frequency", (2.0, 3.0))
    assert one_per_gait(skills) == [0, 2]
    plan = switching_plan([(0, 2), (2, 0)], [[0.5, 0, 0], [0, 0, 0]], 3, 0.8)
    assert plan.skill[[0, 2]].tolist() == [[0, 0, 0, 2, 2, 2], [2, 2, 2, 0, 0, 0]]
    assert plan.command[:, 0].tolist() == [0.5, 0.0, 0.5, 0.0]


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"friction": 0.1}, "give {name: ..., and what differs}"),
        ({"name": "a", "mass": 3.0}, r"conditions\[a\].mass = 3.0: unknown"),
        ({"name": "a", "friction": 0.0}, r"conditions\[a\].friction = 0.0: choose a finite number above 0"),
        ({"name": "a", "payload_mass_kg": -1.0}, "0 or more"),
        ({"name": "a", "noise": "much"}, "give a finite number"),
    ],
)
def test_a_wrong_condition_is_refused(entry, message):
    with pytest.raises(ConfigError, match=message):
        check_conditions("robustness.conditions", [entry])


def test_conditions_of_one_name_are_refused():
    with pytest.raises(ConfigError, match="name each condition once"):
        check_conditions("robustness.conditions", [{"name": "a"}, {"name": "a"}])


def test_trouble_meets_only_its_own_robots(config, clips):
    grid = grid_plan(1, [[0.5, 0.0, 0.0]], 40, 0.8)
    entries = ({"name": "nominal"}, {"name": "pushed", "push_m_s": 0.5}, {"name": "noisy", "noise": 1.0})
    conditions = [Condition.of(entry) for entry in (*entries, {"name": "loaded", "payload_mass_kg": 3.0})]
    seen: list[torch.Tensor] = []

    def stand(observation):
        seen.append(observation)
        return torch.zeros(len(observation), 12)

    recording = roll_out(stand, config, disturbed_plan(grid, conditions, 0.8, 0.4), clips, seed=0)
    assert not recording.fallen.any()
    alone = roll_out(stand, config, grid, clips, seed=0)
    assert (recording.qpos[0] == alone.qpos[0]).all()
    assert (recording.qpos[1, :20] == alone.qpos[0, :20]).all()  # the first push comes after .4 s
    assert abs(recording.velocity[1, 20]).max() > 0.2
    assert (recording.qpos[2] == alone.qpos[0]).all()  # a standing policy does not look at its observation
    assert (seen[0][2] != seen[0][0]).any() and (seen[0][1] == seen[0][0]).all()
    assert recording.qpos[3, -1, 2] < recording.qpos[0, -1, 2] - 0.005  # sags
