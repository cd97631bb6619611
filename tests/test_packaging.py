"""What a clone and a wheel promise: pinned dependencies, complete contents, clear errors of the Makefile."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from omegaconf import OmegaConf
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from camp.common.paths import ablation_root, assets_root, config_root, repository_root

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
LISTS = {"": PROJECT["dependencies"], **PROJECT["optional-dependencies"]}

needs_make = pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")


def constraints() -> list[str]:
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def files_below(folder: Path, *suffixes: str) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*") if path.suffix in suffixes}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """The wheel of this tree, built without the network."""
    if find_spec("hatchling") is None:
        pytest.skip("hatchling is not installed; it comes with the dev extra")
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*command, "--wheel-dir", str(folder), str(ROOT)], check=True, capture_output=True)
    (built,) = folder.glob("camp-*.whl")
    return built


def test_folders_in_the_repository():
    assert repository_root() == ROOT
    assert config_root() == ROOT / "conf" and (config_root() / "train.yaml").is_file()
    assert ablation_root() == ROOT / "ablations" and (ablation_root() / "ablation").is_dir()
    assert assets_root() == ROOT / "src" / "camp" / "assets"


def test_constraints_pin_exactly_and_name_no_place():
    for line in constraints():
        assert re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.]+", line), line
    assert "torch==2.13.0" in constraints()  # without +cpu: any build of that version fits


@pytest.mark.parametrize("extra", sorted(LISTS))
def test_every_dependency_is_pinned_to_a_version_it_allows(extra):
    pins = {canonicalize_name(name): version for name, version in (line.split("==") for line in constraints())}
    for requirement in map(Requirement, LISTS[extra]):
        if requirement.name == "camp":  # one extra includes another
            assert requirement.extras <= set(LISTS)
            continue
        assert requirement.specifier.contains(pins[canonicalize_name(requirement.name)], prereleases=True)


def test_wheel_holds_code_configurations_and_data(wheel):
    with zipfile.ZipFile(wheel) as archive:
        packed = {Path(name) for name in archive.namelist()}
    package = ROOT / "src" / "camp"
    wanted = {
        Path("camp") / path
        for path in files_below(package, ".py", ".xml", ".npz", ".pt", ".yaml", ".json", ".jsonl", ".md")
    }
    wanted |= {Path("camp/conf") / path for path in files_below(ROOT / "conf", ".yaml")}
    wanted |= {Path("camp/ablations") / path for path in files_below(ROOT / "ablations", ".yaml")}
    assert wanted - packed == set()
    assert {Path("camp/conf/train.yaml"), Path("camp/robots/go2.xml")} <= packed
    tops = {path.parts[0] for path in packed}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"camp"}
    assert not any("__pycache__" in path.parts for path in packed)


@pytest.mark.slow
def test_wheel_composes_from_an_empty_folder(wheel, tmp_path):
    installed, workplace = tmp_path / "installed", tmp_path / "workplace"
    workplace.mkdir()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(installed)
    command = [sys.executable, "-m", "camp.train", "+ablation=no_skill_disc", "--cfg", "job"]
    environment = os.environ | {"PYTHONPATH": str(installed)}
    result = subprocess.run(command, capture_output=True, text=True, cwd=workplace, env=environment)
    assert result.returncode == 0, result.stderr
    assert "variant: no_skill_disc" in result.stdout
    assert list(workplace.iterdir()) == []


@needs_make
def test_lint_changes_no_file_and_is_what_ci_runs_first():
    shown = subprocess.run(["make", "-n", "lint"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert '/ruff" format --check .' in shown and '/ruff" check .' in shown and '/pyright"' in shown
    assert "--fix" not in shown
    run = [line.split()[-1] for line in (ROOT / ".ci" / "run").read_text().splitlines() if line.startswith("make ")]
    assert run == ["lint", "test"]


def test_hooks_download_nothing_and_use_pinned_tools():
    config: Any = OmegaConf.to_container(OmegaConf.load(ROOT / ".pre-commit-config.yaml"))
    developing = {requirement.name for requirement in map(Requirement, LISTS["dev"])}
    for repository in config["repos"]:
        assert repository["repo"] == "local"
        for hook in repository["hooks"]:
            assert hook["language"] == "system"
            assert Path(hook["entry"].split()[0]).parent == Path(".venv/bin")
            assert Path(hook["entry"].split()[0]).name in developing


@needs_make
def test_help_lists_every_target():
    shown = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    phony = re.search(r"^\.PHONY:(.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert phony is not None
    for target in phony[1].split():
        assert f"make {target} " in shown


@needs_make
@pytest.mark.parametrize(
    ("script", "message"),
    [
        (None, "no such command; install Python 3.11"),
        (
            "#!/bin/sh\n[ $1 = -V ] && echo Python 3.9.1 || exit 1\n",
            "is Python 3.9.1: camp needs 3.11 or newer",
        ),
        ('#!/bin/sh\ncase "$2" in *ensurepip*) exit 1;; esac\n', "the venv module is missing"),
    ],
)
def test_make_names_what_is_wrong_with_python(tmp_path, script, message):
    python = tmp_path / "python"
    if script is not None:
        python.write_text(script)
        python.chmod(0o755)
    command = ["make", "setup", f"PYTHON={python}", f"VENV={tmp_path / 'venv'}"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert result.returncode != 0
    (error,) = [line for line in result.stderr.splitlines() if line.startswith("error: ")]
    assert str(python) in error and message in error
    assert not (tmp_path / "venv").exists()
