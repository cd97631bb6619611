"""Live gait readings on contacts made by hand."""

from __future__ import annotations

import torch

from camp.data import Step
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import skill_set
from camp.metrics.gait import measure_gait
from camp.training import gait_monitor
from camp.training.gait_monitor import MAX_READ, GaitMonitor

SKILLS = skill_set(("trot", "pace", "bound", "pronk"), "gait", ())


def step(contact: torch.Tensor, skill: torch.Tensor, ended: torch.Tensor) -> Step:
    num = len(skill)
    nothing = torch.zeros(num)
    return Step(
        observation=nothing,
        privileged=nothing,
        final_observation=nothing,
        final_privileged=nothing,
        reward={},
        task_reward=nothing,
        terminated=ended,
        truncated=torch.zeros(num, dtype=torch.bool),
        diverged=torch.zeros(num, dtype=torch.bool),
        transition=nothing,
        skill=skill,
        command=torch.zeros(num, 3),
        velocity=torch.zeros(num, 3),
        foot_contact=contact,
    )


def contacts(gait: str, t: int) -> list[bool]:
    return [((t * 0.02 * 2.5 - offset) % 1.0) < 0.5 for offset in GAIT_PHASES[gait]]


def feed(monitor: GaitMonitor, shown: list[str], skill: list[int], steps: int, end_at: int | None = None) -> None:
    for t in range(steps):
        contact = torch.tensor([contacts(gait, t) for gait in shown])
        ended = torch.full((len(shown),), t == end_at)
        monitor.add(step(contact, torch.tensor(skill), ended))


def monitor(num: int) -> GaitMonitor:
    return GaitMonitor(SKILLS, num, window_s=2.0, period_s=0.02, device=torch.device("cpu"))


def test_right_gaits_score_and_wrong_ones_do_not():
    reading = monitor(5)
    feed(reading, ["trot", "pace", "bound", "pronk", "trot"], [0, 1, 2, 3, 1], 130)
    metrics = reading.read()
    assert metrics["gait/trot/accuracy"] == 1.0
    assert metrics["gait/pace/accuracy"] == 0.5
    assert metrics["gait/bound/accuracy"] == metrics["gait/pronk/accuracy"] == 1.0
    assert metrics["gait/stepping"] == 1.0


def test_robots_count_only_after_a_window_under_one_skill():
    reading = monitor(1)
    feed(reading, ["trot"], [0], 99)
    assert reading.read() == {}
    feed(reading, ["trot"], [0], 1)
    assert reading.read() != {}
    feed(reading, ["trot"], [2], 99)  # another skill is commanded
    assert reading.read() == {}
    feed(reading, ["trot"], [2], 1)
    assert reading.read()["gait/bound/accuracy"] == 0.0


def test_an_ended_episode_starts_the_window_anew():
    reading = monitor(1)
    feed(reading, ["trot"], [0], 120, end_at=60)
    assert reading.read() == {}


def test_state_round_trip():
    one, other = monitor(2), monitor(2)
    feed(one, ["trot", "bound"], [0, 2], 110)
    other.load_state_dict(one.state_dict())
    assert other.read() == one.read() != {}


def test_reading_is_bounded(monkeypatch):
    reading, seen = monitor(400), []
    feed(reading, ["trot"] * 400, [0] * 400, 100)

    def spy(contact, period_s):
        seen.append(len(contact))
        return measure_gait(contact, period_s)

    monkeypatch.setattr(gait_monitor, "measure_gait", spy)
    assert reading.read()["gait/trot/accuracy"] == 1.0
    assert seen == [MAX_READ]
