"""Ctrl-C in any command, at any time: one line and the shell's code for it, no traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import analysis.__main__ as figures
from analysis import animation, seeds
from camp import dataset, export, judge, leaderboard, ship
from camp.cli.key_values import run_command

ROOT = Path(__file__).parents[2]


def interrupt(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("work", "main"),
    [
        ("camp.export.export_policy", lambda: run_command(export.export, ["run=a"], "")),
        ("camp.ship.ship_policy", lambda: run_command(ship.ship, ["run=a", "name=b"], "")),
        ("camp.judge.judge_expert", lambda: run_command(judge.judge, ["expert"], "")),
        ("camp.leaderboard._read", lambda: run_command(leaderboard.leaderboard, [], "")),
        ("camp.dataset.judge", lambda: dataset.main(["validate"])),
        ("analysis.__main__.run_folder", lambda: figures.main(["run=a"])),
        ("analysis.seeds.read_report", lambda: seeds.main(["a", "b"])),
        ("analysis.animation.policy_of_run", lambda: run_command(animation.animate, ["run=a"], "")),
    ],
)
def test_while_it_works(work, main, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(work, interrupt)
    if "dataset" not in work:
        monkeypatch.chdir(tmp_path)
    assert main() == 130
    assert capsys.readouterr().err == "interrupted\n"


@pytest.mark.parametrize("command", ["camp.export", "camp.train", "camp.ship", "analysis"])
def test_while_it_imports(command, tmp_path):
    """A package that is interrupted as soon as it is imported stands in for torch, which takes seconds."""
    (tmp_path / "torch.py").write_text(f"import os, signal\nos.kill(os.getpid(), {int(signal.SIGINT)})\n")
    path = os.pathsep.join([str(tmp_path), str(ROOT / "src"), str(ROOT)])
    done = subprocess.run(
        [sys.executable, "-m", command, "run=a"], env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True
    )
    assert done.stderr == "interrupted\n" and done.returncode == -signal.SIGINT
