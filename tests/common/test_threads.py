"""Torch's and the simulator's threads, alone and beside other processes."""

from __future__ import annotations

import pytest

from camp.common import threads
from camp.common.threads import threads_of_process


@pytest.fixture(autouse=True)
def eight_processors(monkeypatch):
    monkeypatch.setattr(threads, "_processors", lambda: 8)
    for name in ("OMP_NUM_THREADS", "LOCAL_WORLD_SIZE"):
        monkeypatch.delenv(name, raising=False)


def test_alone_the_libraries_take_what_there_is():
    assert threads_of_process(0) == 0 and threads_of_process(3) == 3


@pytest.mark.parametrize(("ranks", "share"), [(2, 4), (3, 2), (16, 1)])
def test_ranks_on_one_machine_share_its_processors(ranks, share, monkeypatch):
    monkeypatch.setenv("LOCAL_WORLD_SIZE", str(ranks))
    monkeypatch.setenv("OMP_NUM_THREADS", "1")  # torchrun's own
    assert threads_of_process(0) == share and threads_of_process(5) == 5


def test_the_bound_of_a_launcher_counts_for_the_simulator_too(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    assert threads_of_process(0) == 2 and threads_of_process(3) == 3
    monkeypatch.setenv("OMP_NUM_THREADS", "4,2")  # per nesting level, which only OpenMP itself can read
    assert threads_of_process(0) == 0
