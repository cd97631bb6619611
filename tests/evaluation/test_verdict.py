"""Targets met and missed."""

from __future__ import annotations

from camp.evaluation.config import TargetsConfig
from camp.evaluation.verdict import judge_targets

TARGETS = TargetsConfig(
    gait_accuracy=0.95,
    switches_established=0.95,
    falls_per_100_episodes=1.0,
    linear_error_m_s=0.15,
    yaw_rate_error_rad_s=0.15,
    joint_tracking=0.914,
)
GRID = {
    "skills": {"trot": {"gait_accuracy": 1.0}, "pace": {"gait_accuracy": 0.9}},
    "all": {
        "falls": 1,
        "rollouts": 50,
        "linear_error_m_s": 0.15,
        "yaw_rate_error_rad_s": 0.2,
        "joint_tracking": {"thigh": 0.92, "calf": 0.90},
    },
}
SWITCHING = {"established": 0.97, "within_s": 1.0, "falls": 0, "sequences": 50, "joint_tracking": {"thigh": 0.95}}


def verdict(report: dict) -> dict[str, tuple[float | None, bool]]:
    return {finding.name: (finding.reached, finding.met) for finding in judge_targets(report, TARGETS)}


def test_every_target_beside_what_was_reached():
    found = verdict({"policies": {"trained": GRID}, "switching": SWITCHING})
    assert found["gait accuracy"] == (0.9, False)  # the weakest skill counts
    assert found["switches established"] == (0.97, True)
    assert found["falls per 100 episodes"] == (1.0, True)  # 1 in 50 + 50
    assert found["velocity error, m/s"] == (0.15, True)  # a bound that is just reached is met
    assert found["yaw rate error, rad/s"] == (0.2, False)
    assert found["joint tracking, thigh"] == (0.95, True)
    assert found["joint tracking, calf"] == (None, False)  # nothing measured is not met


def test_only_what_was_evaluated_is_judged():
    alone = verdict({"policies": {"trained": GRID}})
    assert "switches established" not in alone and alone["falls per 100 episodes"] == (2.0, False)
    assert alone["joint tracking, thigh"] == (0.92, True)
    one_gait = SWITCHING | {"established": None}
    assert "switches established" not in verdict({"policies": {"trained": GRID}, "switching": one_gait})
    assert verdict({}) == {}
