"""The recipes of docs/extending.md, followed to the letter on a copy of the project."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from camp.motion.clips.store import load_clip

ROOT = Path(__file__).parent.parent
PAGE = "docs/extending.md"
COPIED = ("src", "conf", "ablations", "analysis", "docs", "tests", "pyproject.toml")
BLOCK = re.compile(r"([^\n]*)\n\n```(python|yaml|diff|sh)\n(.*?)```", re.DOTALL)
pytestmark = pytest.mark.slow


@pytest.fixture
def project(tmp_path) -> Path:
    """A copy of the project."""
    for name in COPIED:
        source, target = ROOT / name, tmp_path / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)
    return tmp_path


def recipe(heading: str) -> list[tuple[str, str, str]]:
    """The blocks of a section of the page: the line before each, its language and its text."""
    text = (ROOT / PAGE).read_text(encoding="utf-8")
    section = re.split(r"^## ", text.split(f"\n## {heading}\n")[1], flags=re.MULTILINE)[0]
    return BLOCK.findall(section)


def follow(project: Path, heading: str) -> None:
    """Edit the files and run the commands of a section, in order."""
    for line, language, text in recipe(heading):
        if language == "sh":
            for command in text.replace("\\\n", "").splitlines():
                run(project, command)
        elif language == "diff":
            (project / "change.diff").write_text(text)
            run(project, "git apply change.diff")
        else:
            edit(project, line, text)


def edit(project: Path, line: str, text: str) -> None:
    """Carry out "In a new file `file`:", "At the end of `file`:" or "In `file`, below `start of a line`:"."""
    if new := re.fullmatch(r"In a new file `(.+)`:", line):
        assert not (project / new[1]).exists()
        (project / new[1]).write_text(text)
        return
    if end := re.fullmatch(r"At the end of `(.+)`:", line):
        path = project / end[1]
        path.write_text(f"{path.read_text()}\n\n{text}")
        return
    place = re.fullmatch(r"In `(.+)`, below `(.+)`:", line)
    assert place, line
    path = project / place[1]
    lines = path.read_text().splitlines(keepends=True)
    (number,) = (number for number, one in enumerate(lines) if one.strip().startswith(place[2]))
    path.write_text("".join([*lines[: number + 1], text, *lines[number + 1 :]]))


def run(project: Path, command: str) -> str:
    """Run a command line in the project, on its own sources; returns what it prints."""
    environment = os.environ | {
        "PYTHONPATH": f"{project / 'src'}{os.pathsep}{project}",
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "OMP_NUM_THREADS": "1",
        "WANDB_MODE": "disabled",
    }
    done = subprocess.run(command, shell=True, cwd=project, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def metrics(project: Path) -> dict[str, Any]:
    """The last row of the newest run."""
    return json.loads((project / "outputs/latest/metrics.jsonl").read_text().splitlines()[-1])


def test_a_reward_term(project):
    follow(project, "A reward term")
    row = metrics(project)
    raw = row["reward/body_height/raw"]
    assert 0.0 < raw < 0.05
    assert row["reward/body_height/weighted"] == pytest.approx(-20.0 * raw)
    weighted = [row[f"reward/{name}/weighted"] for name in ("linear_velocity", "angular_velocity", "body_height")]
    assert row["reward/task/weighted"] == pytest.approx(sum(weighted), rel=1e-4)
    # A policy that was trained before: its configuration does not know the term.
    shipped = "src/camp/assets/policies/go2_camp"
    assert "body_height" not in (project / shipped / "config.yaml").read_text()
    run(project, f"python -m camp.export run={shipped} output=exported")
    assert (project / "exported/policy.onnx").is_file()


def test_an_observation_term(project):
    follow(project, "An observation term")
    observed = json.loads((project / "outputs/latest/policy.json").read_text())["observation"]
    assert observed[0] == {"name": "joint_torque", "size": 12, "unit": "N m"}
    assert len(observed) == 8
    table = (project / "docs/observations.md").read_text()
    assert "| 0..11 | `joint_torque` | 12 | N m | joint | 1 | - |" in table


def test_a_gait(project):
    follow(project, "A gait")
    report = json.loads((project / "outputs/latest/eval.json").read_text())
    assert set(report["policies"]["trained"]["confusion"]) == {"trot", "walk"}
    assert report["expert"]["walk"]["duty"] in (0.625, None)
    assert "prior/skill/accuracy/walk" in metrics(project)
    assert (project / "outputs/latest/figures/contacts.png").is_file()
    known = run(project, WALK_IS_READ)
    assert known.split() == ["walk", "#56B4E9"]


def test_a_robot(project):
    follow(project, "A robot")
    clip = load_clip(project / "src/camp/assets/motions/tall/trot_3hz_forward_0.6.npz")
    assert clip.base_linear_velocity[:, 0].mean() == pytest.approx(0.6, abs=0.05)
    assert "name: tall" in (project / "outputs/latest/config.yaml").read_text()


# The expert's own clip, read by foot contacts, and the colour of its strip in the figure.
WALK_IS_READ = (
    'python -c "from camp.motion.clips.store import load_clip; from camp.metrics.gait import measure_gait; '
    "from pathlib import Path; from analysis.style import GAIT_COLOURS; "
    "clip = load_clip(Path('src/camp/assets/motions/go2/walk_3hz_forward_0.6.npz')); "
    'label = measure_gait(clip.foot_contact[None], clip.dt).label[0]; print(label, GAIT_COLOURS[label])"'
)
