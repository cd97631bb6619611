"""Replay buffer: a ring that keeps the latest transitions."""

from __future__ import annotations

import copy

import torch

from camp.algo.replay import ReplayBuffer
from camp.data import Transition
from tests.algo.synthetic import assert_identical, rng


def numbered(first: int, count: int) -> Transition:
    number = torch.arange(first, first + count)
    return Transition(number.float().view(-1, 1, 1).expand(count, 2, 3), number)


def kept(buffer: ReplayBuffer) -> set[int]:
    sample = buffer.sample(2000, rng())
    assert torch.equal(sample.state[:, 0, 0].long(), sample.skill)  # states keep their labels
    return set(sample.skill.tolist())


def test_oldest_transitions_leave_first():
    buffer = ReplayBuffer(5, (2, 3), torch.device("cpu"))
    buffer.add(numbered(0, 3))
    assert len(buffer) == 3 and kept(buffer) == {0, 1, 2}
    buffer.add(numbered(3, 4))
    assert len(buffer) == 5 and kept(buffer) == {2, 3, 4, 5, 6}


def test_more_than_fits_keeps_the_last():
    buffer = ReplayBuffer(5, (2, 3), torch.device("cpu"))
    buffer.add(numbered(0, 12))
    assert kept(buffer) == {7, 8, 9, 10, 11}


def test_restored_buffer_continues_where_it_was():
    buffer = ReplayBuffer(5, (2, 3), torch.device("cpu"))
    buffer.add(numbered(0, 3))
    restored = ReplayBuffer(5, (2, 3), torch.device("cpu"))
    restored.load_state_dict(copy.deepcopy(buffer.state_dict()))
    for ring in (buffer, restored):
        ring.add(numbered(3, 4))
    assert_identical(buffer.state_dict(), restored.state_dict())
