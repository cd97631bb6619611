"""Every figure by its name, drawn of a small run, its evaluation and the shipped results."""

from __future__ import annotations

import pytest

from analysis import segments
from analysis.gallery import FIGURES, Sources
from analysis.study_results import RESULTS
from analysis.style import save_both
from camp.common.paths import repository_root
from tests.analysis.synthetic import metrics, write_metrics
from tests.evaluation.test_evaluate import CONDITIONS, judged
from tests.small_run import small_run

pytestmark = [pytest.mark.slow, pytest.mark.dtw]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    skills = ["motion.skills=[trot,pronk]", "motion.labels=gait_frequency", "motion.frequencies_hz=[2.0,3.0]"]
    folder = small_run(tmp_path_factory.mktemp("run") / "one", skills)
    write_metrics(folder, metrics(12))
    judged(folder, "parts=[gait,table_i,reference,robustness]", CONDITIONS, "video=false")
    return folder


@pytest.fixture
def sources(folder, monkeypatch):
    monkeypatch.setattr(segments, "WALK_S", (0.1, 0.5))  # before an untrained policy falls
    monkeypatch.setattr(segments, "reference_segments", lambda run, _: run.clips[::10])  # the expert's own take long
    root = repository_root()
    assert root is not None
    return Sources(folder, root / RESULTS)


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_drawn(name, sources, tmp_path):
    paths = save_both(FIGURES[name](sources), tmp_path, name)
    assert [path.suffix for path in paths] == [".png", ".pdf"]
    assert all(path.stat().st_size > 5_000 for path in paths)
