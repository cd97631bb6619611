"""The benchmark prints what it should; its numbers are nobody's to test."""

from __future__ import annotations

import pytest
from omegaconf import OmegaConf

from camp import bench, contenders
from camp.compose import compose_config
from camp.config import as_yaml

TINY = ["run=smoke", "sim.threads=1", "run.rollout_steps=2", "motion.num_preloaded=400"]


def test_a_gpu_is_measured_with_a_quarter_to_four_times_the_robots():
    assert bench.robot_counts(compose_config(["sim=gpu", "sim.device=cpu"])) == (1024, 4096, 8192, 16384)
    assert bench.robot_counts(compose_config(["sim=gpu", "sim.device=cpu", "sim.num_envs=2"])) == (1, 2, 4, 8)
    assert bench.robot_counts(compose_config(["sim=cpu", "sim.num_envs=96"])) == (96,)


@pytest.mark.slow
def test_the_gpu_benchmark_on_warps_cpu_device(monkeypatch, capsys):
    pytest.importorskip("mujoco_warp", reason="mujoco_warp is not installed; it comes with the gpu and dev extras")
    monkeypatch.setattr(contenders, "STEPS", 2)
    monkeypatch.setattr(bench, "ROUNDS", 1)
    monkeypatch.setattr(bench, "robot_counts", lambda config: (4, 6))
    config = compose_config([*TINY, "sim=gpu", "sim.device=cpu", "device=cpu"])
    bench.bench(OmegaConf.create(OmegaConf.to_yaml(as_yaml(config))))
    lines = capsys.readouterr().out.splitlines()
    for words in (("4 robots,",), ("6 robots,",)):
        assert sum(all(word in line for word in words) for line in lines) == 1
    for words in ("mujoco_warp, bare", "camp env.step", "one training iteration", "physics", "networks", "rest"):
        assert sum(words in line for line in lines) == 2, words
