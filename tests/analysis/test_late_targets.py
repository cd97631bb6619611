"""Walks with late targets: the shipped policy bears what one that was trained without latency does not."""

from __future__ import annotations

import pytest

from analysis.late_targets import late_targets, walks_late
from camp.cli.key_values import run_command
from camp.common.paths import policies_root
from camp.deployment.export import policy_of_run


@pytest.mark.slow
def test_latency_is_borne_by_the_policy_that_was_trained_with_it():
    shipped, before = (policy_of_run(policies_root() / name) for name in ("go2_camp", "go2_eight"))
    assert walks_late(shipped, "trot_3hz", 0.6, 0.02) and walks_late(before, "trot_3hz", 0.6, 0.0)
    assert not walks_late(before, "trot_3hz", 0.6, 0.02)


@pytest.mark.parametrize("late", ["soon", "-1", "0.2", "nan"])
def test_a_latency_that_cannot_be_is_told(late, capsys):
    assert run_command(late_targets, ["policy=a", f"late_s={late}"], None) == 2
    assert "late_s = " in capsys.readouterr().err
