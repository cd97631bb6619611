"""What figures roll out of a run: the 10-s sequence, and walks as the skill discriminator sees them."""

from __future__ import annotations

import numpy as np
import pytest

from analysis import segments
from analysis.contacts import diagram_of
from analysis.sequence import roll_sequence
from camp.build import load_run
from tests.small_run import small_run

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=["false", "true"])
def folder(request, tmp_path_factory):
    overrides = [
        f"env.foot_stance={request.param}",
        "motion.skills=[trot,pronk]",
        "motion.labels=gait_frequency",
        "motion.frequencies_hz=[2.0,3.0]",
    ]
    return small_run(tmp_path_factory.mktemp("run") / "one", overrides)


def test_the_sequence_has_one_skill_of_each_gait(folder):
    run = load_run(folder)
    recording = roll_sequence(run, folder)
    diagram = diagram_of(recording, run.skills)
    assert [(span.name, span.start_s, span.end_s) for span in diagram.commanded] == [
        *(("trot_3hz", 0.0, 2.5), ("pronk_3hz", 2.5, 5.0))
    ]
    assert diagram.touches is not None and len(diagram.touches) == 4


def test_upright_walks_become_features_of_their_skills(folder, monkeypatch):
    run = load_run(folder)
    monkeypatch.setattr(segments, "WALK_S", (0.1, 0.3))  # before an untrained policy falls
    walks = segments.policy_walks(run, folder)
    assert {(walk.gait, walk.frequency_hz) for walk in walks} <= {(g, f) for g in ("trot", "pronk") for f in (2.0, 3.0)}
    assert walks and all(walk.feature.shape == (14, 12) for walk in walks)
    assert {tuple(np.round(walk.command.astype(float), 2).tolist()) for walk in walks} <= {
        (0.6, 0.0, 0.0),
        (0.45, 0.1, 0.2),
    }


def test_segments_are_made_once(folder, tmp_path, monkeypatch):
    run, made = load_run(folder), []

    class Pool:
        def __init__(self, workers):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def map(self, task, jobs):
            made.extend(request.name for _, request, _ in jobs)
            for _, request, place in jobs:
                segments.save_clip(segments._path(request, place), run.clips[0])

    monkeypatch.setattr(segments, "get_context", lambda method: type("Context", (), {"Pool": Pool}))
    assert len(segments.reference_segments(run, tmp_path)) == 4
    assert len(segments.segment_features(run, tmp_path)) == 4
    assert made == [f"{g}_{f}hz_forward_0.45_left_0.1_turn_left_0.2" for g in ("trot", "pronk") for f in (2, 3)]
