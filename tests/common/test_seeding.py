"""Streams are reproducible, independent of each other, and continue exactly from a saved state."""

from __future__ import annotations

import random
import subprocess
import sys

import numpy as np
import pytest
import torch

from camp.common.seeding import (
    generator,
    generator_state,
    global_state,
    restore_generator,
    restore_global_state,
    seed_everything,
)
from camp.runs.checkpoint import load_checkpoint, save_checkpoint


def draw(source: torch.Generator, count: int = 8) -> list[float]:
    return torch.rand(count, generator=source).tolist()


def draw_globally() -> tuple[float, float, float, float]:
    # The Gaussian of NumPy's old generator comes in pairs, and the second one waits in its state.
    return random.random(), np.random.random(), np.random.standard_normal(), torch.rand(()).item()


def test_stream_depends_on_seed_and_name_alone():
    assert draw(generator(3, "policy")) == draw(generator(3, "policy"))
    different = [draw(generator(3, "policy")), draw(generator(3, "environment")), draw(generator(4, "policy"))]
    assert different[0] != different[1] and different[0] != different[2]


def test_drawing_from_one_stream_does_not_shift_another():
    expected = draw(generator(0, "environment"))
    environment, policy = generator(0, "environment"), generator(0, "policy")
    draw(policy, 1000)
    assert draw(environment) == expected


def test_streams_are_uncorrelated():
    streams = torch.stack([torch.randn(20_000, generator=generator(0, f"stream {i}")) for i in range(8)])
    correlation = torch.corrcoef(streams) - torch.eye(8)
    assert correlation.abs().max() < 5 / 20_000**0.5  # five standard errors


def test_same_numbers_in_another_process():
    code = "from camp.common.seeding import generator; print(generator(7, 'policy').initial_seed())"
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(other.stdout) == generator(7, "policy").initial_seed()


def test_seed_everything_covers_the_global_generators():
    seed_everything(11)
    first = draw_globally()
    assert draw_globally() != first
    seed_everything(11)
    assert draw_globally() == first


def test_negative_seed_is_refused():
    with pytest.raises(ValueError, match="seed -1"):
        seed_everything(-1)


def test_generator_continues_from_a_checkpoint(tmp_path):
    source = generator(1, "minibatches")
    draw(source, 13)
    path = save_checkpoint(tmp_path / "state.pt", {"minibatches": generator_state(source)})
    expected = draw(source)
    other = generator(99, "minibatches")
    restore_generator(other, load_checkpoint(path)["minibatches"])
    assert draw(other) == expected


def test_global_generators_continue_from_a_checkpoint(tmp_path):
    seed_everything(5)
    draw_globally()
    path = save_checkpoint(tmp_path / "state.pt", global_state())
    expected = draw_globally()
    seed_everything(6)
    restore_global_state(load_checkpoint(path))
    assert draw_globally() == expected
