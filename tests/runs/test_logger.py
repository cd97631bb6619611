"""The record of a run: metrics lines, versions, and W&B runs that end, group and continue as promised."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import torch
from omegaconf import OmegaConf

from camp.common.errors import CheckpointError, ConfigError
from camp.runs.config import LoggerConfig
from camp.runs.logger import RunLogger
from camp.runs.metrics import read_metrics, truncate_metrics
from camp.runs.versions import collect_versions, git_state
from camp.runs.wandb_run import RunIdentity

CONFIG = OmegaConf.create({"seed": 3, "algo": {"name": "camp", "copy": "${seed}"}})
DISABLED = LoggerConfig("disabled", "camp", [])
OFFLINE = LoggerConfig("offline", "camp", ["own"])


def identity(folder: Path) -> RunIdentity:
    folder.mkdir(parents=True, exist_ok=True)
    return RunIdentity(folder, group="camp", tags=["go2"])


def log_until(folder: Path, last: int, logger: LoggerConfig = DISABLED) -> list[str]:
    announced: list[str] = []
    with RunLogger(identity(folder), logger, CONFIG, announce=announced.append) as record:
        for iteration in range(1, last + 1):
            record.log(iteration, {"reward/style/raw": iteration / 3, "ppo/kl": torch.tensor(0.5).item()})
    return announced


def wandb_record(run: Path) -> dict:
    """What `wandb leet` reads from a local W&B run."""
    command = [sys.executable, "-m", "wandb", "leet", "inspect", "--summary", "--json", str(run)]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def test_metrics_come_back_exactly(tmp_path):
    log_until(tmp_path, 3)
    assert read_metrics(tmp_path / "metrics.jsonl") == [
        {"iteration": i, "reward/style/raw": i / 3, "ppo/kl": 0.5} for i in (1, 2, 3)
    ]


def test_every_line_is_on_disk_at_once_and_strict_json(tmp_path):
    record = RunLogger(identity(tmp_path), DISABLED, CONFIG)
    record.log(1, {"a": math.nan, "b": -math.inf, "c": 1.0})
    line = (tmp_path / "metrics.jsonl").read_text()

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    assert json.loads(line, parse_constant=refuse) == {"iteration": 1, "a": None, "b": None, "c": 1.0}
    record.finish()
    record.finish()  # a `finally` after the `with` does no harm


def test_a_full_disk_is_one_line_and_leaves_whole_lines(tmp_path):
    with RunLogger(identity(tmp_path / "my run"), DISABLED, CONFIG) as record:
        record.log(1, {"a": 1.0})
        usable, record._file = record._file, open("/dev/full", "ab", buffering=0)  # noqa: SIM115
        with pytest.raises(ConfigError, match=r"No space left on device; free some space, then continue with") as full:
            record.log(2, {"a": 2.0})
        record._file.close()
        record._file = usable
    assert str(full.value).endswith(f"python -m camp.train 'resume={tmp_path / 'my run'}'")
    assert read_metrics(tmp_path / "my run" / "metrics.jsonl") == [{"iteration": 1, "a": 1.0}]


def test_resume_cuts_what_the_checkpoint_does_not_know(tmp_path):
    log_until(tmp_path, 5)
    uninterrupted = (tmp_path / "metrics.jsonl").read_text()
    with (tmp_path / "metrics.jsonl").open("a") as file:
        file.write('{"iteration": 6, "reward/st')  # torn by a kill
    with RunLogger(identity(tmp_path), DISABLED, CONFIG, resume_from=3) as record:
        for iteration in (4, 5):
            record.log(iteration, {"reward/style/raw": iteration / 3, "ppo/kl": 0.5})
    assert (tmp_path / "metrics.jsonl").read_text() == uninterrupted
    assert (tmp_path / "versions.json").is_file() and (tmp_path / "versions-00000003.json").is_file()


@pytest.mark.parametrize("line", ["not json", '{"no": 1}', "[1]", '{"iteration": null}'])
def test_damaged_line_is_named_and_nothing_is_changed(tmp_path, line):
    path = tmp_path / "metrics.jsonl"
    path.write_text(f'{{"iteration": 1}}\n{line}\n{{"iteration": 3}}\n')
    before = path.read_bytes()
    with pytest.raises(CheckpointError, match=r"metrics\.jsonl line 2: not a metrics line \(.*\); restore"):
        truncate_metrics(path, 2)
    assert path.read_bytes() == before


def test_resume_without_metrics(tmp_path):
    with pytest.raises(CheckpointError, match=r"metrics\.jsonl: unreadable"):
        RunLogger(identity(tmp_path), DISABLED, CONFIG, resume_from=3)


def test_config_is_kept_resolved(tmp_path):
    log_until(tmp_path, 1)
    kept = OmegaConf.load(tmp_path / "config.yaml")
    assert OmegaConf.to_container(kept) == {"seed": 3, "algo": {"name": "camp", "copy": 3}}


def test_versions_name_code_packages_and_machine():
    versions = collect_versions()
    assert versions["packages"]["torch"] == torch.__version__
    assert versions["packages"]["mujoco"] == "4.0.0"
    assert versions["python"] == ".".join(map(str, sys.version_info[:3]))
    assert versions["cpu_count"] >= 1 and versions["command"] == sys.argv
    json.dumps(versions)


def test_git_state(tmp_path):
    def git(*arguments: str) -> str:
        who = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        command = ["git", "-C", str(tmp_path), *who, *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    assert git_state(None) is None and git_state(tmp_path) is None
    git("init")
    assert git_state(tmp_path) is None  # no commit yet
    git("commit", "--allow-empty", "-m", "first")
    assert git_state(tmp_path) == {"commit": git("rev-parse", "HEAD"), "dirty": False}
    (tmp_path / "file").write_text("")
    assert git_state(tmp_path) == {"commit": git("rev-parse", "HEAD"), "dirty": True}


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (LoggerConfig("of", "camp", []), "logger.wandb_mode = 'of': choose one of offline, online, disabled"),
        (LoggerConfig("offline", "a/b", []), "logger.wandb_project = 'a/b'"),
        (LoggerConfig("offline", "", []), "logger.wandb_project = ''"),
    ],
)
def test_wrong_settings_are_named(config, message):
    with pytest.raises(ConfigError, match=message):
        config.check()


def test_three_runs_in_one_process_make_three_wandb_runs_in_one_group(tmp_path, capfd):
    announced = [log_until(tmp_path / f"run{seed}", 2, OFFLINE) for seed in range(3)]
    shown = capfd.readouterr()
    assert shown.out == shown.err == ""
    index = tmp_path / "wandb"
    assert len(list(index.iterdir())) == 3
    for seed in range(3):
        (run,) = (tmp_path / f"run{seed}" / "wandb").glob("offline-run-*")
        assert (index / run.name).resolve() == run
        assert "wandb leet" in announced[seed][0] and "wandb sync" in announced[seed][0]
        assert len(announced[seed]) == 1
    last = wandb_record(run)
    assert (last["name"], last["project"], last["state"], last["step"]) == ("run2", "camp", "finished", 2)
    assert last["summary"]["reward/style/raw"] == 2 / 3


def test_group_tags_and_config_reach_wandb(tmp_path):
    log_until(tmp_path / "run", 2, OFFLINE)
    (run,) = (tmp_path / "run" / "wandb").glob("offline-run-*")
    command = [sys.executable, "-m", "wandb", "leet", "inspect", "--json", str(run)]
    records = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    (start,) = (json.loads(line) for line in records.splitlines() if '"type":"run"' in line)
    text = json.dumps(start)
    for part in ('"camp"', '"go2"', '"own"', "seed"):
        assert part in text
    assert records.count('"type":"history"') == 2


def test_histograms_are_lists_on_disk_and_histograms_in_wandb(tmp_path):
    fractions = [0.0] * 23 + [1.0]
    with RunLogger(identity(tmp_path / "run"), OFFLINE, CONFIG, announce=lambda _: None) as record:
        record.log(1, {"ppo/kl": 0.5, "logits": fractions})
    assert read_metrics(tmp_path / "run" / "metrics.jsonl") == [{"iteration": 1, "ppo/kl": 0.5, "logits": fractions}]
    (run,) = (tmp_path / "run" / "wandb").glob("offline-run-*")
    found = wandb_record(run)["summary"]["logits"]
    assert found == {"_type": "histogram", "values": fractions, "bins": [-3.0 + 0.25 * edge for edge in range(25)]}


def test_resumed_run_continues_the_same_wandb_id(tmp_path):
    log_until(tmp_path / "run", 3, OFFLINE)
    with RunLogger(identity(tmp_path / "run"), OFFLINE, CONFIG, resume_from=2, announce=lambda _: None) as record:
        record.log(3, {"ppo/kl": 0.5})
    files = list((tmp_path / "run" / "wandb").glob("offline-run-*/run-*.wandb"))
    assert len(files) == 2  # offline, a resumed run is a second file of the same id
    assert len({file.name for file in files}) == 1


def test_announced_sync_command_finds_the_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (line,) = log_until(Path("outputs/run 1"), 1, OFFLINE)
    sync = line.split("upload this one: ")[1]
    executable = shutil.which("wandb", path=str(Path(sys.executable).parent)) or "wandb"
    command = sync.replace("wandb sync", f"{executable} sync --dry-run", 1)
    shown = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert "Would sync 1 run(s)" in shown.stdout + shown.stderr
    assert "wandb leet outputs/wandb " in line


def test_disabled_writes_nothing_of_wandb(tmp_path):
    assert log_until(tmp_path / "run", 1) == []
    assert not (tmp_path / "wandb").exists() and not (tmp_path / "run" / "wandb").exists()


def test_failed_run_is_marked_as_failed(tmp_path):
    with (
        pytest.raises(ZeroDivisionError),
        RunLogger(identity(tmp_path / "run"), OFFLINE, CONFIG, announce=lambda _: None),
    ):
        raise ZeroDivisionError
    (run,) = (tmp_path / "run" / "wandb").glob("offline-run-*")
    assert wandb_record(run)["exit_code"] == 1
