"""A training that cannot fit the machine is refused before anything is built, with what takes most."""

from __future__ import annotations

import pytest

from camp.build import build_training
from camp.common.errors import ConfigError
from camp.config import memory
from camp.config.compose import compose_config


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (["sim.num_envs=1048576"], "sim.num_envs = 1048576"),
        (["algo.actor.hidden=[16384,16384,16384]"], "algo.actor.hidden = [16384, 16384, 16384]"),
        (["algo.style.batch_size=4194304"], "algo.style.batch_size = 4194304"),
        (["algo.style.replay_size=100000000"], "algo.style.replay_size = 100000000"),
    ],
)
def test_what_does_not_fit_is_one_line(monkeypatch, change, key):
    monkeypatch.setattr(memory, "machine_memory", lambda: 4 * 2**30)
    with pytest.raises(ConfigError) as caught:
        build_training(compose_config(["run=smoke", "sim=cpu", "device=cpu", *change]))
    line = str(caught.value)
    assert line.startswith(f"{key}: this takes about ") and line.endswith("this machine has 4.0 GiB; choose less")


@pytest.mark.parametrize("preset", ["quick", "scratch", "paper"])
def test_the_presets_fit_four_gibibytes(preset):
    config = compose_config([f"run={preset}", "sim=cpu", "device=cpu"])
    assert 10 * 2**20 < sum(memory.parts(config).values()) < 4 * 2**30


def test_the_machine_has_memory():
    assert 2**28 < memory.machine_memory() < 2**50
