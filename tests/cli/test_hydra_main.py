"""Command lines over a small configuration of their own: sweeps, ablations, one-line errors, run folders."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from hydra.core.config_store import ConfigStore
from omegaconf import MISSING, DictConfig, OmegaConf

import camp.cli.hydra_main
import camp.config.compose
import camp.config.hydra_errors
from camp.cli.hydra_main import EXIT_BUG, EXIT_INPUT, EXIT_INTERRUPTED, run_hydra
from camp.common.errors import ConfigError
from camp.runs.folder import new_run_folder
from tests.errors import assert_one_line

FILES = {
    "conf/train.yaml": """
        defaults:
          - cli_test_schema
          - algo: camp
          - _self_
          - override hydra/job_logging: none
          - override hydra/hydra_logging: none
        seed: 0
        hydra:
          output_subdir: null
          run: {dir: .}
          sweep: {dir: outputs/.sweep, subdir: .}
        """,
    "conf/algo/camp.yaml": "name: camp\nppo: {learning_rate: 1e-3, epochs: 5}",
    "conf/algo/amp.yaml": "name: amp\nppo: {learning_rate: 1e-3, epochs: 5}",
    "ablations/ablation/no_skill_disc.yaml": "# @package _global_\nalgo:\n  name: no_skill_disc",
    "ablations/ablation/typo.yaml": "# @package _global_\nalgo:\n  pppo:\n    epochs: 1",
}


@dataclass
class PPO:
    learning_rate: float = MISSING
    epochs: int = MISSING


@dataclass
class Algo:
    name: str = MISSING
    ppo: PPO = field(default_factory=PPO)


@dataclass
class Train:
    seed: int = MISSING
    algo: Algo = field(default_factory=Algo)


@pytest.fixture(autouse=True)
def tree(tmp_path, monkeypatch) -> Path:
    """A folder with conf/ and ablations/, which the command line takes for camp's own."""
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(textwrap.dedent(text))
    monkeypatch.setattr(camp.cli.hydra_main, "config_root", lambda: tmp_path / "conf")
    for module in (camp.config.compose, camp.config.hydra_errors):
        monkeypatch.setattr(module, "ablation_root", lambda: tmp_path / "ablations")
    monkeypatch.delenv("CAMP_DEBUG", raising=False)
    ConfigStore.instance().store(name="cli_test_schema", node=Train)
    workplace = tmp_path / "workplace"
    workplace.mkdir()
    monkeypatch.chdir(workplace)
    return tmp_path


class Recorder:
    """A task that remembers its configurations and fails where a test wants it to."""

    def __init__(self, failures: dict[int, BaseException] | None = None) -> None:
        self.failures = failures or {}
        self.seeds: list[int] = []
        self.names: list[str] = []

    def __call__(self, config: DictConfig) -> None:
        self.seeds.append(config.seed)
        self.names.append(config.algo.name)
        if config.seed in self.failures:
            raise self.failures[config.seed]


def refuse(arguments: str, capsys) -> str:
    """Run a command line that must fail before the task starts, and return its only line on stderr."""
    task = Recorder()
    assert run_hydra("train", task, arguments.split()) == EXIT_INPUT
    assert task.seeds == []
    captured = capsys.readouterr()
    assert captured.out == ""
    assert_one_line(captured.err)
    assert list(Path.cwd().iterdir()) == []
    return captured.err


def test_plain_run_composes_and_leaves_no_folder(capsys):
    task = Recorder()
    assert run_hydra("train", task, ["algo=amp", "seed=4"]) == 0
    assert (task.seeds, task.names) == ([4], ["amp"])
    assert list(Path.cwd().iterdir()) == []
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    "arguments",
    [
        "+ablation=no_skill_disc -m seed=0,1,2",  # the literal command that hydra.main refuses
        "-m +ablation=no_skill_disc seed=0,1,2",
        "--multirun +ablation=no_skill_disc seed=0,1,2",
        "+ablation=no_skill_disc seed=0,1,2 -m",
    ],
)
def test_sweep_with_the_flag_anywhere(arguments):
    task = Recorder()
    assert run_hydra("train", task, arguments.split()) == 0
    assert task.seeds == [0, 1, 2]
    assert task.names == ["no_skill_disc"] * 3
    assert [entry.name for entry in Path.cwd().rglob("*")] == ["outputs", ".sweep", "multirun.yaml"]


def test_literal_command_in_a_process_of_its_own(tree):
    program = tree / "program.py"
    program.write_text(
        textwrap.dedent(
            """
            import sys
            from pathlib import Path
            import camp.cli.hydra_main
            import camp.config.compose
            from tests.cli.test_hydra_main import Train
            from hydra.core.config_store import ConfigStore

            ConfigStore.instance().store(name="cli_test_schema", node=Train)
            root = Path(__file__).parent
            camp.cli.hydra_main.config_root = lambda: root / "conf"
            camp.config.compose.ablation_root = lambda: root / "ablations"
            sys.exit(camp.cli.hydra_main.run_hydra("train", lambda config: print(config.algo.name, config.seed)))
            """
        )
    )
    command = [sys.executable, str(program), "+ablation=no_skill_disc", "-m", "seed=0,1,2"]
    repository = Path(__file__).parents[2]
    environment = os.environ | {"PYTHONPATH": f"{repository}{os.pathsep}{repository / 'src'}"}
    result = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [
        line
        for seed in range(3)
        for line in (f"job {seed + 1} of 3: +ablation=no_skill_disc seed={seed}", f"no_skill_disc {seed}")
    ]


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (
            "+ablation=no_skill",
            ["ablation 'no_skill'", "did you mean no_skill_disc?", "choose one of no_skill_disc"],
        ),
        ("algo=tdmpc", ["algo 'tdmpc'", "choose one of amp, camp"]),
        ("ablation=no_skill_disc", ["'ablation'", "write +ablation=no_skill_disc"]),
        ("sed=1", ["sed: unknown key", "did you mean seed?"]),
        ("algo.ppo.learnin_rate=1", ["algo.ppo.learnin_rate", "did you mean algo.ppo.learning_rate?"]),
        ("epochs=3", ["epochs: unknown key", "did you mean algo.ppo.epochs?"]),
        ("+ablation=typo", ["config ablation/typo: algo.pppo: unknown key", "algo.ppo"]),
        ("ablatoin=no_skill_disc", ["ablatoin: unknown key", "did you mean +ablation?"]),
        ("seed=abc", ["seed 'abc': wrong type", "write a value like 0"]),
        ("seed=1e6", ["seed 1000000.0: wrong type", "write 1000000"]),
        ("algo.ppo.epochs=null", ["algo.ppo.epochs None: wrong type", "write a value like 5"]),
        ("algo.ppo=3", ["algo.ppo 3: wrong type"]),
        ("seed=[", ["override 'seed=['", "write key=value"]),
        ("seed", ["override 'seed'", "write key=value"]),
        ("seed=0,1", ["override 'seed=0,1'", "[0,1]", "add -m"]),
        ("+seed=1", ["+seed", "leave the + out"]),
        ("~sed", ["~sed: no such key"]),
        ("--seed=1", ["--seed=1", "overrides have no dashes: seed=1"]),
        ("--run=x", ["--run=x", "takes no value", "overrides have no dashes: run=x"]),
        ("--cfg=all-of-it", ["--cfg", "all-of-it", "see --hydra-help"]),
        ("--mutirun", ["--mutirun", "did you mean --multirun?"]),
        ("--config-name", ["--config-name: has no value"]),
        ("--config-name nope", ["config 'nope': not found"]),
        ("-m seed=0,abc", ["seed 'abc': wrong type"]),
    ],
)
def test_wrong_input_ends_in_one_line(arguments, parts, capsys, tree):
    if arguments.startswith("-m"):  # the sweeper has written its multirun.yaml by then
        assert run_hydra("train", Recorder(), arguments.split()) == EXIT_INPUT
        line = capsys.readouterr().err
        assert line.count("\n") == 1
    else:
        line = refuse(arguments, capsys)
    for part in parts:
        assert part in line
    assert str(tree) not in line


def test_error_inside_the_task_is_one_line_too(capsys):
    task = Recorder({0: ConfigError("env.count 0: must be at least 1;\n write env.count=1")})
    assert run_hydra("train", task, []) == EXIT_INPUT
    assert capsys.readouterr().err == "error: env.count 0: must be at least 1; write env.count=1\n"


def test_strict_merge_inside_the_task_names_an_appended_key(capsys):
    """`+key=value` passes Hydra even when no schema knows the key; a strict merge is what refuses it."""

    def resolve(config: DictConfig) -> None:
        OmegaConf.merge(OmegaConf.structured(Train), OmegaConf.to_container(config))

    assert run_hydra("train", resolve, ["+algo.ppo.epoch=1"]) == EXIT_INPUT
    assert capsys.readouterr().err == "error: algo.ppo.epoch: unknown key; did you mean algo.ppo.epochs?\n"


def test_missing_value_and_dangling_reference(capsys):
    assert run_hydra("train", lambda config: config.seed, ["seed=???"]) == EXIT_INPUT
    assert "error: seed: has no value; set it with seed=" in capsys.readouterr().err
    assert run_hydra("train", lambda config: config.seed, ["seed=${nowhere}"]) == EXIT_INPUT
    assert "error: seed: refers to what is not there" in capsys.readouterr().err


def test_bug_keeps_its_traceback():
    with pytest.raises(ZeroDivisionError) as caught:
        run_hydra("train", Recorder({0: ZeroDivisionError("a bug")}), [])
    assert "Recorder" in repr(caught.traceback[-1].locals["self"])


def test_debug_shows_the_traceback(monkeypatch, capsys):
    monkeypatch.setenv("CAMP_DEBUG", "1")
    assert run_hydra("train", Recorder({0: ConfigError("seed 0: no")}), []) == EXIT_INPUT
    shown = capsys.readouterr().err
    assert "Traceback" in shown and shown.endswith("error: seed 0: no\n")


def test_sweep_goes_on_after_failures_and_reports_them(capsys):
    task = Recorder({1: ConfigError("seed 1: unlucky; write 2"), 2: ZeroDivisionError("a bug")})
    assert run_hydra("train", task, ["-m", "seed=0,1,2,3"]) == EXIT_BUG
    assert task.seeds == [0, 1, 2, 3]
    shown = capsys.readouterr().err
    assert shown.startswith("error: job 1: seed 1: unlucky; write 2\n")
    assert shown.endswith("ZeroDivisionError: a bug\n")


def test_interrupt_ends_a_sweep(capsys):
    task = Recorder({1: KeyboardInterrupt()})
    assert run_hydra("train", task, ["-m", "seed=0,1,2"]) == EXIT_INTERRUPTED
    assert task.seeds == [0, 1]
    assert capsys.readouterr().err == "interrupted\n"


def test_arguments_and_environment_are_left_as_they_were(monkeypatch):
    monkeypatch.delenv("HYDRA_FULL_ERROR", raising=False)
    arguments = list(sys.argv)
    run_hydra("train", Recorder({0: ConfigError("x")}), [])
    assert sys.argv == arguments and "HYDRA_FULL_ERROR" not in os.environ


def test_help_and_cfg_still_work(capsys):
    assert run_hydra("train", Recorder(), ["--help"]) == 0
    assert "algo: amp, camp" in capsys.readouterr().out
    assert run_hydra("train", Recorder(), ["--cfg", "job", "seed=3"]) == 0
    assert "seed: 3" in capsys.readouterr().out


def test_run_folders_never_collide(tmp_path):
    root = tmp_path / "outputs"
    folders = [new_run_folder(root, "camp-s0") for _ in range(5)]
    assert len(set(folders)) == 5
    assert all(folder.parent == root and "-camp-s0" in folder.name for folder in folders)
    assert (root / "latest").resolve() == folders[-1]
    assert sorted(entry.name for entry in root.iterdir()) == sorted(["latest", *(f.name for f in folders)])


def test_run_folders_made_at_the_same_time_never_collide(tmp_path):
    with ThreadPoolExecutor(8) as pool:
        folders = list(pool.map(lambda _: new_run_folder(tmp_path, "x"), range(80)))
    assert len(set(folders)) == 80
    assert (tmp_path / "latest").resolve() in folders


def test_run_folder_in_a_place_that_is_a_file(tmp_path):
    (tmp_path / "outputs").write_text("")
    with pytest.raises(ConfigError, match=r"output folder .*outputs.*; choose one that can be written"):
        new_run_folder(tmp_path / "outputs", "x")
