"""Averages over minibatches of unequal size."""

from __future__ import annotations

import pytest
import torch

from camp.common.averages import Averages


def test_every_element_counts_once():
    averages = Averages()
    averages.add("loss", torch.tensor([1.0, 2.0, 3.0]))
    averages.add("loss", torch.tensor(10.0))
    assert averages.result() == {"loss": pytest.approx(4.0)}


def test_masked_elements_do_not_count():
    averages = Averages()
    averages.add("error", torch.tensor([1.0, 2.0, 6.0]), where=torch.tensor([True, False, True]))
    averages.add("error", torch.tensor([8.0, 9.0]), where=torch.tensor([True, False]))
    averages.add("nothing", torch.tensor([float("inf")]), where=torch.tensor([False]))
    assert averages.result() == {"error": pytest.approx(5.0)}


def test_means_per_skill_leave_out_what_was_not_seen():
    averages = Averages()
    right = torch.tensor([True, False, True])
    averages.add_per_skill("accuracy", right, torch.tensor([0, 0, 2]), ("trot", "pace", "bound"))
    assert averages.result() == {"accuracy/trot": 0.5, "accuracy/bound": 1.0}


def test_nothing_added_gives_nothing():
    assert Averages().result() == {}
