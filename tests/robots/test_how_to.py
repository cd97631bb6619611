"""The how-to "A robot" of docs/extending.md, followed to the letter on a copy."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from camp.common.paths import repository_root
from camp.motion.clips.store import load_clip

NEEDED = ("src/camp", "conf", "ablations", "tests", "pyproject.toml")


def blocks(text: str, language: str) -> list[str]:
    """The fenced blocks of a language, in their order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def copied(tmp_path_factory) -> tuple[Path, str]:
    """A copy of the project without its clips and policies, and the how-to."""
    root = repository_root()
    if root is None:
        pytest.skip("no source checkout")
    how_to = (root / "docs" / "extending.md").read_text(encoding="utf-8")
    section = re.search(r"^## A robot\n.*?(?=^## |\Z)", how_to, re.MULTILINE | re.DOTALL)
    assert section is not None
    copy = tmp_path_factory.mktemp("project")
    for name in NEEDED:
        if (root / name).is_file():
            shutil.copy(root / name, copy / name)
        else:
            shutil.copytree(root / name, copy / name, ignore=shutil.ignore_patterns("assets", "__pycache__"))
    return copy, section[0]


def run(command: str, folder: Path) -> str:
    """What a shell command prints; `python` is the one that runs the tests."""
    environment = os.environ | {
        "PYTHONPATH": str(folder / "src"),
        "OMP_NUM_THREADS": "1",
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "WANDB_MODE": "disabled",
    }
    done = subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.mark.slow
def test_a_robot_is_added_as_the_how_to_says(copied):
    copy, text = copied
    model, commands = blocks(text, "sh")
    run(model, copy)
    (constants,) = blocks(text, "python")
    (copy / "src/camp/robots/tall.py").write_text(constants, encoding="utf-8")
    (change,) = blocks(text, "diff")
    (copy / "change.diff").write_text(change, encoding="utf-8")
    run("git apply change.diff", copy)
    (gains,) = blocks(text, "yaml")
    (copy / "conf/robot/tall.yaml").write_text(gains, encoding="utf-8")

    for path in ("src/camp/robots/tall.py", "src/camp/robots/tall.xml", "src/camp/robots/registry.py"):
        assert f"`{path}`" in text or path in model
    check, generate, validate, train = commands.strip().splitlines()
    assert re.search(r"[1-9]\d* passed", run(check, copy))
    assert "1 made, 0 kept, 0 failed" in run(generate, copy)
    clip = load_clip(copy / "src/camp/assets/motions/tall/trot_3hz_forward_0.6.npz")
    assert clip.base_linear_velocity[:, 0].mean() == pytest.approx(0.6, abs=0.05)
    assert "1 clips, 0 bad" in run(validate, copy)
    run(train, copy)
    config = (copy / "outputs" / "latest" / "config.yaml").read_text()
    assert "name: tall" in config
