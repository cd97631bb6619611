"""eval.json: written and read by the same classes; old and damaged ones are one line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from camp.evaluation.record import metrics
from camp.evaluation.report import ReportError, as_json, as_plain, read_report, write_report
from camp.evaluation.tables import printed, verdict_markdown
from camp.evaluation.values import fraction
from camp.evaluation.verdict import judge_targets
from tests.evaluation.reports import gait_summary, policy_summary, report
from tests.evaluation.test_verdict import TARGETS


def judged():
    skills = {"trot": gait_summary(fraction(np.ones(80, dtype=bool)), 80, frequency=None)}
    found = report(policies={"trained": policy_summary(skills)})
    found.verdict = judge_targets(found, TARGETS)
    return found


def test_a_report_survives_its_file(tmp_path):
    write_report(tmp_path / "eval.json", judged())
    assert read_report(tmp_path / "eval.json", "evaluate again") == judged()
    assert json.loads(as_json(judged())) == json.loads(json.dumps(as_plain(judged()), allow_nan=False))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"run": "a", "verdict": []}', "of another format than 2"),
        ("{", "Invalid JSON"),
        ("[1]", "no evaluation's report"),
        ('{"format": 1}', "of another format than 2, by an older or newer judge"),
        (None, "No such file"),
    ],
)
def test_what_is_no_report_is_one_line(text, message, tmp_path):
    path = tmp_path / "eval.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(ReportError) as caught:
        read_report(path, "evaluate again")
    assert message in str(caught.value) and "\n" not in str(caught.value)
    assert "evaluate again" in str(caught.value) and str(path) in str(caught.value)


def test_a_wrong_value_is_named(tmp_path):
    content = json.loads(as_json(judged()))
    content["policies"]["trained"]["all"]["falls"] = "many"
    (tmp_path / "eval.json").write_text(json.dumps(content))
    with pytest.raises(ReportError, match=r"policies\.trained\.all\.falls: Input should be a valid integer"):
        read_report(tmp_path / "eval.json", "evaluate again")


def test_the_parts_without_the_policys_own_walks_are_printed():
    """parts=[robustness]: of the gaits there are the baselines' alone."""
    found = report(policies={"standing": policy_summary({"trot": gait_summary(None, 4)})})
    titles = [table.title for table in printed(found, 80).renderables]
    assert titles == ["gaits, nominal", "gaits, nominal (further columns)"]


def test_figures_without_a_value_are_printed_and_logged_as_none():
    found = judged()
    assert printed(found, 80).renderables
    logged = metrics(found)
    assert logged["evaluation/policies/trained/all/gait_accuracy/value"] == 1.0
    assert logged["evaluation/verdict/gait_accuracy"] == 1.0
    assert "evaluation/policies/trained/skills/trot/frequency_hz" not in logged


def test_the_verdict_in_markdown():
    lines = verdict_markdown(judged().verdict).splitlines()
    assert lines[2] == "| gait accuracy (weakest skill: trot) | >= 0.95 | 1.000 | 0.954 to 1.000 | 80 | shown |"
