"""Targets shown, not shown and missed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camp.evaluation.config import TargetsConfig
from camp.evaluation.report import TableI
from camp.evaluation.values import fraction, mean_estimate
from camp.evaluation.verdict import judge_targets
from tests.evaluation.reports import gait_summary, policy_summary, report, switching_summary, tracking_summary

TARGETS = TargetsConfig(
    gait_accuracy=0.95,
    table_i_accuracy=0.9,
    switches_completed=0.95,
    falls_per_100_episodes=1.0,
    linear_error_m_s=0.15,
    yaw_rate_error_rad_s=0.15,
)


def verdict(found) -> dict[str, tuple[str, int]]:
    return {one.name: (one.verdict, one.n) for one in judge_targets(found, TARGETS)}


def of(right: int, n: int):
    return fraction(np.arange(n) < right)


def test_every_target_by_its_interval():
    skills = {"trot": gait_summary(of(80, 80), 80), "pace": gait_summary(of(79, 80), 80)}
    whole = replace(
        report(),
        policies={"trained": policy_summary(skills, falls=0)},
        table_i=TableI(policy_summary({"trot": gait_summary(of(20, 80), 80)}, falls=9), []),
        switching=switching_summary(of(224, 224), falls=0, sequences=76),
        tracking={"all": tracking_summary(mean_estimate(np.full(80, 0.2)), mean_estimate(np.full(80, 0.1)))},
    )
    assert verdict(whole) == {
        "gait accuracy": ("not shown", 80),  # 79 of 80: the interval reaches below .95
        "gait accuracy, Table I": ("missed", 80),
        "switches completed": ("shown", 224),
        "falls per 100 episodes": ("not shown", 236),  # none in 236: at most 1.6
        "velocity error, m/s": ("missed", 80),
        "yaw rate error, rad/s": ("shown", 80),
    }
    found = judge_targets(whole, TARGETS)[0]
    assert found.note == "weakest skill: pace" and found.reached == 79 / 80


def test_falls_need_many_walks():
    calm = replace(report(), policies={"trained": policy_summary({"trot": gait_summary(of(640, 640), 640)}, falls=0)})
    assert verdict(calm)["falls per 100 episodes"] == ("shown", 640)


def test_only_what_was_evaluated_is_judged():
    assert verdict(report()) == {}
    one_skill = replace(report(), switching=switching_summary(None, falls=0, sequences=3))
    assert list(verdict(one_skill)) == ["falls per 100 episodes"]
