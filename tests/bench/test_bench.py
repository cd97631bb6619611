"""The benchmark prints what it should; its numbers are nobody's to test."""

from __future__ import annotations

import pytest
from omegaconf import OmegaConf

from camp.bench import baselines, measure
from camp.config.compose import compose_config
from camp.config.resolve import as_yaml

TINY = ["run=smoke", "sim.threads=1", "run.rollout_steps=2", "motion.num_preloaded=400"]


def test_a_gpu_is_measured_with_a_quarter_to_four_times_the_robots():
    assert measure.robot_counts(compose_config(["run=gpu", "sim=gpu", "sim.device=cpu"])) == (1024, 4096, 8192, 16384)
    assert measure.robot_counts(compose_config(["sim=gpu", "sim.device=cpu", "sim.num_envs=2"])) == (1, 2, 4, 8)
    assert measure.robot_counts(compose_config(["sim=cpu", "sim.num_envs=96"])) == (96,)


@pytest.mark.slow
def test_the_gpu_benchmark_on_warps_cpu_device(monkeypatch, capsys):
    pytest.importorskip("mujoco_warp", reason="mujoco_warp is not installed; it comes with the gpu and dev extras")
    monkeypatch.setattr(baselines, "STEPS", 2)
    monkeypatch.setattr(measure, "ROUNDS", 1)
    monkeypatch.setattr(measure, "robot_counts", lambda config: (4, 6))
    config = compose_config([*TINY, "sim=gpu", "sim.device=cpu", "device=cpu"])
    measure.bench(OmegaConf.create(OmegaConf.to_yaml(as_yaml(config))))
    lines = capsys.readouterr().out.splitlines()
    for words in (("4 robots,",), ("6 robots,",)):
        assert sum(all(word in line for word in words) for line in lines) == 1
    for words in ("mujoco_warp, bare", "camp env.step", "one training iteration", "physics", "networks", "rest"):
        assert sum(words in line for line in lines) == 2, words
