"""Operations of matrix products are counted as worked out by hand, those of gradients of gradients too."""

from __future__ import annotations

import torch

from camp.algo.losses import gradient_penalty
from camp.bench.arithmetic import Meter, Operations


def test_a_layer_and_its_gradients_are_three_products():
    layer, inputs = torch.nn.Linear(5, 3), torch.rand(7, 5, requires_grad=True)
    with Operations() as counted:
        layer(inputs).sum().backward()
    assert counted.total == 3 * 2 * 7 * 5 * 3  # forward, gradient of the weights, gradient of the inputs


def test_the_gradient_penalty_can_be_counted():
    layer, inputs = torch.nn.Linear(5, 1), torch.rand(7, 5, requires_grad=True)
    with Operations() as counted:
        gradient_penalty(layer(inputs), inputs).backward()
    assert counted.total >= 2 * 2 * 7 * 5


def test_a_meter_counts_or_takes_the_time():
    meter, layer = Meter(), torch.nn.Linear(5, 3, bias=False)
    meter.watch(layer, "forward")
    layer(torch.rand(7, 5))
    assert meter.operations == 0
    assert meter.seconds > 0.0
    meter.counting = True
    layer(torch.rand(7, 5))
    assert meter.operations == 2 * 7 * 5 * 3
