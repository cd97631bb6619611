"""A suite's name stands for its values."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camp.evaluation.report import SuiteStamp
from camp.evaluation.suite import SUITES, stamp, whole_digest
from camp.robots.a1 import A1
from camp.robots.go2 import GO2
from tests.evaluation.suites import evaluation


@pytest.mark.parametrize("robot", [GO2, A1], ids=["go2", "a1"])
@pytest.mark.parametrize(("file", "name"), [("full", "v1"), ("short", "short")])
def test_the_shipped_values_are_those_of_the_name(file, name, robot):
    """Fails when what is measured has changed: give the suite another name, and its digest to SUITES."""
    found = stamp(evaluation(f"suite={file}"), robot)
    assert SUITES[name][robot.name] == whole_digest(found)
    assert found.name == name and found.robot == robot.name


def test_the_go2s_suite_is_what_it_was_before_there_was_another_robot():
    assert SUITES["v1"]["go2"] == "16c610e718590d52" and SUITES["short"]["go2"] == "e574727a364cdd12"
    assert SuiteStamp("v1", "a", "b", "c", 0).robot == "go2"


def test_robots_differ_by_their_model_alone():
    go2, a1 = stamp(evaluation(), GO2), stamp(evaluation(), A1)
    assert (go2.name, go2.digest, go2.thresholds) == (a1.name, a1.digest, a1.thresholds) and go2.model != a1.model


def test_a_model_that_nobody_named_is_another_suite(tmp_path):
    path = tmp_path / "go2.xml"
    path.write_bytes(GO2.model_path.read_bytes() + b"<!-- -->")
    assert stamp(evaluation(), replace(GO2, model_path=path)).name == "custom"
    assert stamp(evaluation(), replace(GO2, name="tall")).name == "custom"


@pytest.mark.parametrize(
    "change", ["seed=1", "walks.per_skill=60", "discard_s=1", "parts=[gait]", "table_i.push_m_s=0"]
)
def test_another_value_is_another_suite(change):
    assert stamp(evaluation(change), GO2).name == "custom"


def test_what_is_not_measured_does_not_matter():
    other = evaluation("video=false", "threads=1", "targets.gait_accuracy=0.5", "baselines=false")
    assert stamp(other, GO2).name == "v1"
