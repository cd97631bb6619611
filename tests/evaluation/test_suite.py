"""A suite's name stands for its values."""

from __future__ import annotations

import pytest

from camp.evaluation.suite import SUITES, stamp, whole_digest
from tests.evaluation.suites import evaluation


@pytest.mark.parametrize(("file", "name"), [("full", "v1"), ("short", "short")])
def test_the_shipped_values_are_those_of_the_name(file, name):
    """Fails when what is measured has changed: give the suite another name, and its digest to SUITES."""
    found = stamp(evaluation(f"suite={file}"))
    assert SUITES[name] == whole_digest(found)
    assert found.name == name


@pytest.mark.parametrize(
    "change", ["seed=1", "walks.per_skill=60", "discard_s=1", "parts=[gait]", "table_i.push_m_s=0"]
)
def test_another_value_is_another_suite(change):
    assert stamp(evaluation(change)).name == "custom"


def test_what_is_not_measured_does_not_matter():
    assert stamp(evaluation("video=false", "threads=1", "targets.gait_accuracy=0.5", "baselines=false")).name == "v1"
