"""Robots under disturbances: what a condition changes, and what it is refused for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from camp.common.errors import ConfigError
from camp.common.seeding import generator
from camp.envs.config import NoiseConfig
from camp.evaluation.conditions import Condition, check_conditions
from camp.evaluation.controllers import Sight
from camp.evaluation.plan import Disturbances, Plan, joined
from camp.evaluation.recording import record
from camp.evaluation.rollout import Setting, roll_out
from camp.evaluation.sampling import standing_starts
from camp.robots.go2 import GO2
from camp.sim.base import Dynamics

NOISE = NoiseConfig(
    enabled=True, angular_velocity_rad_s=0.2, gravity=0.05, joint_position_rad=0.01, joint_velocity_rad_s=1.5
)
SETTING = Setting(0.02, GO2, NOISE, push_period_s=0.4, seed=0, threads=1)
POSE = torch.tensor(GO2.default_joint_position)


def plan(name: str = "test", num: int = 1, steps: int = 40, delay_s: float = 0.0, **disturbances: float) -> Plan:
    """Robots that stand."""
    dynamics = Dynamics.nominal(num, 0.8, torch.device("cpu"))
    return Plan(
        name,
        torch.zeros(num, steps, dtype=torch.int64),
        torch.zeros(num, 3),
        standing_starts(GO2, num, (1.0, 1.0), generator(0, "starts")),
        replace(dynamics, delay=dynamics.delay + delay_s),
        Disturbances.of(num, **disturbances),
    )


class Stepping:
    """Bends all knees by .1 rad from some time on, and remembers what it saw."""

    def __init__(self, at_s: float = 0.1):
        self._at = at_s

    def start(self, joint_target: torch.Tensor) -> None:
        self.seen: list[Sight] = []

    def __call__(self, sight: Sight) -> torch.Tensor:
        self.seen.append(sight)
        bent = POSE - 0.1 * (POSE < 0) * (sight.time_s >= self._at - 1e-9)
        return bent.expand(len(sight.skill), -1)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"friction": 0.1}, "give {name: ..., and what differs}"),
        ({"name": "a", "mass": 3.0}, r"conditions\[a\].mass = 3.0: unknown"),
        ({"name": "a", "friction": 0.0}, r"conditions\[a\].friction = 0.0: choose a number from 0.001 to 10"),
        ({"name": "a", "payload_mass_kg": -1.0}, "from 0 to 100"),
        ({"name": "a", "noise": "much"}, "choose a number from 0 to 100"),
        ({"name": "a", "loss": 1.0}, "choose a number from 0 to 0.99"),
        ({"name": "a", "delay_s": 0.5}, "choose a number from 0 to 0.1"),
    ],
)
def test_a_wrong_condition_is_refused(entry, message):
    with pytest.raises(ConfigError, match=message):
        check_conditions("robustness.conditions", [entry])


def test_conditions_of_one_name_or_content_are_refused():
    with pytest.raises(ConfigError, match="name each condition once"):
        check_conditions("robustness.conditions", [{"name": "a"}, {"name": "a"}])
    with pytest.raises(ConfigError, match="payload low': is the same as nominal"):
        check_conditions("robustness.conditions", [{"name": "nominal"}, {"name": "payload low", "payload_mass_kg": 0}])


def test_a_condition_becomes_robots():
    condition = Condition.of({"name": "loaded", "payload_mass_kg": 3, "payload_position_m": -0.1, "kp_scale": 0.8})
    robots = condition.dynamics(2, 0.8)
    assert robots.payload_mass.tolist() == [3.0, 3.0] and robots.friction.tolist() == pytest.approx([0.8, 0.8])
    assert robots.payload_position[1].tolist() == pytest.approx([-0.1] * 3)
    assert robots.kp_scale.unique().tolist() == pytest.approx([0.8])


def test_trouble_meets_only_its_own_robots():
    loaded = plan("loaded")
    loaded.dynamics.payload_mass[:] = 3.0
    plans = [plan("calm"), plan("pushed", push_m_s=0.5), plan("noisy", noise=1.0), loaded]
    watchers = [Stepping() for _ in plans]
    calm, pushed, noisy, heavy = roll_out(list(zip(plans, watchers, strict=True)), SETTING)
    (alone,) = roll_out([(plan("calm"), Stepping())], SETTING)
    np.testing.assert_array_equal(calm.qpos, alone.qpos)
    np.testing.assert_array_equal(pushed.qpos[0, :21], calm.qpos[0, :21])  # the push comes after .4 s
    assert abs(record(pushed).velocity[0, 20]).max() > 0.2 and record(calm).velocity[0, 20].max() < 0.1
    np.testing.assert_array_equal(noisy.qpos, calm.qpos)  # it does not look at what it sees
    first = [watcher.seen[0].measurement for watcher in watchers]
    assert (first[2].gravity != first[0].gravity).all() and (first[1].gravity == first[0].gravity).all()
    assert heavy.qpos[0, -1, 2] < calm.qpos[0, -1, 2] - 0.005  # sags


def test_what_one_plan_draws_does_not_depend_on_the_others():
    (alone,) = roll_out([(plan("pushed", push_m_s=0.5), Stepping())], SETTING)
    _, together = roll_out([(plan("calm", num=3), Stepping()), (plan("pushed", push_m_s=0.5), Stepping())], SETTING)
    np.testing.assert_array_equal(alone.qpos, together.qpos)


def test_targets_arrive_as_late_as_said():
    """A robot whose targets come d physics steps late does what a prompt one does, d steps later."""
    delays = (0.0, 0.005, 0.01, 0.02, 0.025)
    traces = roll_out([(plan(f"late {d}", steps=120, delay_s=d), Stepping(at_s=2.0)) for d in delays], SETTING)
    knee = np.stack([trace.qpos[0, 100:, 9] for trace in traces])  # row 0: when the bend is commanded
    assert abs(knee[0, 1] - knee[0, 0]) > 0.001
    np.testing.assert_allclose(knee[3, 1:], knee[0, :-1], atol=2e-3)  # 20 ms: one control step later
    moved = abs(knee[:, 1] - knee[:, 0])  # in the control step in which the prompt one bends
    assert moved[0] > moved[1] > moved[2] > 10 * moved[3]
    moved = abs(knee[:, 2] - knee[:, 0])
    assert moved[3] > moved[4] > 0.001  # 20 and 25 ms: in the one after it


def test_lost_targets_leave_the_last_one_in_place():
    calm, lossy = roll_out([(plan("a", steps=80), Stepping()), (plan("b", steps=80, loss=0.9), Stepping())], SETTING)
    assert (lossy.joint_target == calm.joint_target).all()  # what was sent
    differs = np.flatnonzero(abs(lossy.qpos[0] - calm.qpos[0]).max(axis=1) > 1e-5)
    assert differs[0] >= 6 and abs(lossy.qpos[0, -1, 9] - calm.qpos[0, -1, 9]) < 0.01  # arrives at last


def test_shorter_plans_keep_their_length():
    whole = joined("both", [plan(steps=10), plan(num=2, steps=30)])
    assert whole.steps == 30 and len(whole) == 3
    traces = roll_out([(plan("a", steps=10), Stepping()), (plan("b", num=2, steps=30), Stepping())], SETTING)
    assert [trace.qpos.shape[:2] for trace in traces] == [(1, 11), (2, 31)]
    assert traces[0].contact.shape == (1, 40, 4) and traces[0].contact.any()


def test_a_fallen_robot_lies_still():
    tilted = plan(steps=60, num=2)
    tilted.starts.initial.base_quaternion = tilted.starts.initial.base_quaternion.clone()
    tilted.starts.initial.base_quaternion[0] = torch.tensor([0.9, 0.43, 0.0, 0.0]) / 0.9975
    (trace,) = roll_out([(tilted, Stepping())], SETTING)
    assert trace.steps_upright[0] == 0 and trace.steps_upright[1] == 60
    made = record(trace)
    assert made.fallen.tolist() == [True, False]
    assert not made.contact[0].any() and not made.velocity[0].any() and not made.torque[0].any()
    assert made.contact[1].any()


def test_contacts_of_every_physics_step():
    (trace,) = roll_out([(plan(steps=50), Stepping())], SETTING)
    made = record(trace)
    assert made.contact.shape == (1, 200, 4) and made.contact_period_s == pytest.approx(0.005)
    assert made.contact[0, 100:].mean() > 0.95 and made.step_contact.shape == (1, 50, 4)
    assert abs(made.foot_height[0, -1]).max() < 0.01 and made.log(10).contact.shape == (1, 160, 4)
