"""Sweeps on Hydra's launchers; tests/test_docs.py reads the commands of docs/scaling.md."""

from __future__ import annotations

import subprocess
import sys

import pytest
from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from hydra.core.plugins import Plugins
from omegaconf import OmegaConf

from camp.cli.hydra_main import run_hydra
from camp.common.paths import config_root
from camp.config.compose import register_ablations
from camp.train import train
from tests.test_train import QUIET, TINY, environment, error_line, metrics_of, runs_in

SWEEP = ["-m", "seed=0,1", "run=smoke", "run.iterations=2", *TINY]


def train_in(folder, arguments) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "camp.train", *arguments]
    return subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True)


@pytest.mark.slow
@pytest.mark.parametrize("launcher", ["parallel", "submitit_local"])
def test_a_sweep_in_other_processes_trains_all_jobs(launcher, tmp_path):
    arguments = [f"hydra/launcher={launcher}", "+ablation=no_skill_disc", *SWEEP, QUIET]
    done = train_in(tmp_path, arguments)
    assert done.returncode == 0, done.stderr
    runs = runs_in(tmp_path)
    assert {run.name.split("-", 2)[2] for run in runs} == {"no_skill_disc-seed0", "no_skill_disc-seed1"}
    first, second = (metrics_of(run) for run in runs)
    assert len(first) == len(second) == 2 and first != second


@pytest.mark.slow
def test_a_job_that_fails_elsewhere_is_told_and_the_others_go_on(tmp_path):
    arguments = ["hydra/launcher=parallel", *SWEEP, QUIET, "sim.num_envs=8,0"]
    done = train_in(tmp_path, arguments)
    assert done.returncode == 2
    assert "error: job 1: sim.num_envs = 0" in done.stderr and "Traceback" not in done.stderr
    assert len(runs_in(tmp_path)) == 2


def composed(*overrides: str) -> dict:
    register_ablations()
    with initialize_config_dir(str(config_root()), version_base="1.3"):
        config = compose("train", overrides=list(overrides), return_hydra_config=True)
    return OmegaConf.to_container(config.hydra.launcher, resolve=False)  # type: ignore[return-value]


def test_presets_compose():
    assert composed("hydra/launcher=parallel")["n_jobs"] == 2
    slurm = composed("hydra/launcher=slurm", "hydra.launcher.partition=gpu", "hydra.launcher.gpus_per_node=1")
    assert slurm["_target_"].endswith("SlurmLauncher") and slurm["partition"] == "gpu"
    assert slurm["submitit_folder"] == "${hydra.sweep.dir}/slurm/%j"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["hydra/launcher=parallel", "hydra.launcher.n_jobs=0"], ("hydra/launcher=parallel", "n_jobs == 0")),
        (["hydra/launcher=parallel", "hydra.launcher.n_jobs=two"], ("n_jobs", "two", "like 2")),
        (["hydra/launcher=parallel", "hydra.launcher.jobs=2"], ("jobs", "n_jobs")),
        (["hydra/launcher=slurm", "hydra.launcher.cpus=2"], ("cpus", "hydra.launcher")),
        (["hydra/launcher=paralel"], ("paralel", "did you mean parallel?")),
    ],
)
def test_wrong_launcher_values_are_one_line(arguments, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = error_line([*arguments, *SWEEP, QUIET], capsys)
    for word in words:
        assert word in line
    assert runs_in(tmp_path) == []


def test_without_slurm_the_line_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "")
    line = error_line(["hydra/launcher=slurm", *SWEEP, QUIET], capsys)
    assert "srun" in line and "hydra/launcher=slurm" in line


@pytest.mark.parametrize(
    ("preset", "base", "package"),
    [
        ("parallel", "joblib", "hydra-joblib-launcher"),
        ("slurm", "submitit_slurm", "hydra-submitit-launcher"),
    ],
)
def test_a_missing_launcher_names_what_to_install(preset, base, package, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Plugins.instance()  # installed launchers register themselves when the plugins are first looked for
    monkeypatch.delitem(ConfigStore.instance().repo["hydra"]["launcher"], f"{base}.yaml")
    line = error_line([f"hydra/launcher={preset}", *SWEEP, QUIET], capsys)
    assert package in line and "pip install 'camp[sweep]'" in line


def test_a_bug_outside_a_sweep_stays_a_bug(monkeypatch):
    monkeypatch.setattr("camp.cli.hydra_main.hydra.main", lambda **_: lambda job: lambda: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        run_hydra("train", train, [])
