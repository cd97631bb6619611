"""Alarms ring once a condition has lasted, say what helps, and stop with it."""

from __future__ import annotations

import re

import pytest
from omegaconf import OmegaConf

from camp.config.resolve import as_yaml
from camp.training.alarms import AlarmMonitor, alarms_of

WELL = {
    "prior/style/accuracy": 0.8,
    "reward/style/raw": 0.6,
    "prior/style/embedding_similarity": 0.1,
    "prior/skill/accuracy": 0.9,
    "ppo/kl": 0.01,
}
KEY = r"\b(?:algo|env|sim|robot|motion)\.\w+(?:\.\w+)*"  # of the configuration
SATURATED = WELL | {"prior/style/accuracy": 0.999, "reward/style/raw": 0.01}


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("style_saturated", {"prior/style/accuracy": 0.99, "reward/style/raw": 0.05}),
        ("style_blind", {"prior/style/accuracy": 0.5}),
        ("skills_merged", {"prior/style/embedding_similarity": 0.95}),
        ("skill_blind", {"prior/skill/accuracy": 0.25}),
        ("policy_too_fast", {"ppo/kl": 0.5}),
        ("diverged", {"env/diverged_per_1000_steps": 0.04}),
        ("rows_left_out", {"ppo/rows_left_out": 1.0}),
        ("not_finite", {"ppo/kl": float("nan")}),
        ("not_finite", {"reward/style/raw": float("inf")}),
    ],
)
def test_each_condition_rings_alone_and_only_after_its_patience(name, change, config):
    alarms = alarms_of(config)
    patience = next(alarm.patience for alarm in alarms if alarm.name == name)
    monitor = AlarmMonitor(alarms)
    for _ in range(patience - 1):
        assert not any(monitor.update(WELL | change).values()) and monitor.new() == []
    ringing = monitor.update(WELL | change)
    assert [key for key, value in ringing.items() if value] == [f"alarm/{name}"]
    (line,) = monitor.new()
    assert name in line and re.search(KEY, line)


def test_an_alarm_speaks_once_and_again_when_the_condition_returns(config):
    monitor = AlarmMonitor(alarms_of(config))
    lines = []
    for metrics in [SATURATED] * 30 + [WELL] + [SATURATED] * 30:
        monitor.update(metrics)
        lines += monitor.new()
    assert len(lines) == 2


def test_nothing_rings_where_all_is_well_or_nothing_is_trained(config):
    for metrics in (WELL, {}):
        monitor = AlarmMonitor(alarms_of(config))
        for _ in range(500):
            assert not any(monitor.update(metrics).values())


def test_metrics_that_are_not_finite_are_named(config):
    monitor = AlarmMonitor(alarms_of(config))
    monitor.update(WELL | {"ppo/kl": float("nan")})
    assert "alarm not_finite (ppo/kl), for 1 iteration: " in monitor.new()[0]
    monitor.update(WELL)
    monitor.update(dict.fromkeys("abcdef", float("inf")))
    assert "(a, b, c, d and 2 more)" in monitor.new()[0]


def test_a_monitor_goes_on_from_a_checkpoint_without_an_alarm(config):
    monitor = AlarmMonitor(alarms_of(config))
    monitor.load_state_dict({"style_blind": 3})
    assert monitor.update({"ppo/kl": float("nan")})["alarm/not_finite"] == 1.0


def test_a_resumed_monitor_goes_on_counting(config):
    first, second = AlarmMonitor(alarms_of(config)), AlarmMonitor(alarms_of(config))
    for _ in range(19):
        first.update(SATURATED)
    second.load_state_dict(first.state_dict())
    assert second.update(SATURATED)["alarm/style_saturated"] == 1.0


def test_remedies_name_keys_that_exist(config):
    composed = as_yaml(config)
    keys = [key for alarm in alarms_of(config) for key in re.findall(KEY, alarm.remedy)]
    assert len(keys) >= 12
    for key in keys:
        assert OmegaConf.select(composed, key, default=KEY) != KEY, key
