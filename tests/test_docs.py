"""What README.md and the pages promise: modules, make targets and links that exist, commands that are understood."""

from __future__ import annotations

import re
import shlex
from importlib.util import find_spec
from pathlib import Path

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import DictConfig
from torch.distributed.run import get_args_parser

from camp import dataset, deploy, go2, go2_sim
from camp.build import share_of_rank
from camp.common import distributed
from camp.common.paths import config_root
from camp.config.compose import register_ablations
from camp.config.resolve import resolve
from camp.evaluation.config import resolve_evaluation

ROOT = Path(__file__).parents[1]
PAGES = [
    *sorted(ROOT.glob("*.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *(ROOT / "ablations" / "README.md", ROOT / "src/camp/assets/motions/go2/README.md"),
    *sorted((ROOT / "src/camp/assets/policies").glob("*/README.md")),
]
RECIPES = ROOT / "docs" / "extending.md"  # holds once its recipes are followed, which tests/test_extending.py does
HYDRA_OPTIONS = re.compile(r"(-m|--multirun|--cfg|job|hydra|-p|hydra\.launcher)$")


def named(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def lines_of_code(page: Path) -> list[str]:
    """Lines of the shell blocks, indented ones that call Python, and commands within sentences."""
    text = re.sub(r"\\\n\s*", "", page.read_text(encoding="utf-8"))  # continued lines as one
    blocks = "\n".join(re.findall(r"```sh\n(.*?)```", text, re.DOTALL))
    indented = re.findall(r"^ {4}(python -m .*)$", text, re.MULTILINE)
    inline = [" ".join(found.split()) for found in re.findall(r"`((?:python -m|make) [^`]+)`", text)]
    return [*filter(None, blocks.splitlines()), *indented, *inline]


def commands(page: Path) -> list[str]:
    """Without comments, and with something in place of <placeholders>."""
    lines = [
        re.sub(r"\s+#.*", "", line)
        .replace("ablation=<name>", "ablation=no_skill_disc")
        .replace("study=<name>", "study=two_states")
        .replace("seed=<seed>", "seed=0")
        for line in lines_of_code(page)
    ]
    return [re.sub(r"<[^>]*>", "folder", line) for line in lines]


def shown(pattern: str) -> list[str]:
    """The different commands of all pages that begin with a pattern, sorted."""
    pages = [page for page in PAGES if page != RECIPES]
    return sorted({line for page in pages for line in commands(page) if re.match(pattern, line)})


def composed(name: str, arguments: list[str]) -> DictConfig:
    """The first job of a command's configuration."""
    overrides = [re.sub(r"^(seed=\d).*", r"\1", a) for a in arguments if not HYDRA_OPTIONS.match(a)]
    register_ablations()
    with initialize_config_dir(str((config_root() / name).parent), version_base="1.3"):
        return compose(Path(name).name, overrides=overrides, return_hydra_config=True)


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_every_relative_link_resolves(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        place, _, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        linked = (page.parent / place).resolve() if place else page
        assert linked.exists(), f"{named(page)} links {target}"
        if anchor:
            headings = re.findall(r"^#+ (.*)$", linked.read_text(encoding="utf-8"), re.MULTILINE)
            slugs = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
            assert anchor in slugs, f"{named(page)} links {target}"


@pytest.mark.parametrize("page", [page for page in PAGES if page != RECIPES], ids=named)
def test_every_file_that_is_named_exists(page):
    text = page.read_text(encoding="utf-8")
    for place in re.findall(r"`((?:src/camp|tests|conf|analysis|docs|ablations)/[\w/.]*)`", text):
        assert (ROOT / place).exists(), f"{named(page)} names {place}"


def test_the_readme_links_every_page():
    linked = set(re.findall(r"\]\((docs/[\w.]+\.md)", (ROOT / "README.md").read_text(encoding="utf-8")))
    assert linked == {named(page) for page in PAGES if page.parent == ROOT / "docs"}


def test_every_module_and_target_that_is_named_exists():
    modules = {found for page in PAGES for found in re.findall(r"python -m ([a-z0-9_.]*[a-z0-9])", page.read_text())}
    assert {"camp.train", "camp.evaluate", "analysis"} <= modules
    assert [module for module in sorted(modules) if find_spec(module) is None] == []
    targets = {found[1] for line in shown("make ") for found in re.finditer(r"\bmake ([a-z]+)", line)}
    phony = re.search(r"^\.PHONY:(.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert phony is not None and targets and targets <= set(phony[1].split())


@pytest.mark.parametrize("command", shown(r"torchrun |python -m camp\.(train|bench)"))
def test_commands_of_training_compose_and_pass_the_checks(command, monkeypatch):
    """For each job of a sweep and each rank; torchrun knows its options."""
    words, ranks = shlex.split(command), 1
    arguments = words[3:]
    if words[0] == "torchrun":
        options = get_args_parser().parse_args(words[1:])
        ranks, arguments = (
            int(options.nnodes.split(":")[-1]) * int(options.nproc_per_node),
            options.training_script_args,
        )
        assert options.module and options.training_script == "camp.train"
    monkeypatch.setattr(distributed, "size", lambda: ranks)
    whole = resolve(composed("train", arguments))
    assert share_of_rank(whole).sim.num_envs * ranks == whole.sim.num_envs


@pytest.mark.parametrize("command", shown(r"make \w+ .*ARGS="))
def test_what_make_passes_on_composes(command):
    target, *variables = shlex.split(command)[1:]
    values = dict(variable.split("=", 1) for variable in variables)
    if target == "dataset":
        assert dataset._parser().parse_args(values["ARGS"].split())
        return
    arguments = [*values["ARGS"].split(), *([f"sim={values['sim']}"] if "sim" in values else [])]
    name = {"train": "train", "bench": "train", "evaluate": "evaluation/evaluate"}[target]
    assert composed(name, arguments)


@pytest.mark.parametrize("command", shown(r"python -m camp\.evaluate"))
def test_commands_of_the_evaluation_compose_and_pass_the_checks(command):
    given = shlex.split(command)[3:]
    arguments = given if any(argument.startswith("run=") for argument in given) else [*given, "run=folder"]
    assert resolve_evaluation(composed("evaluation/evaluate", arguments)).run


@pytest.mark.parametrize("command", shown(r"python -m camp\.dataset"))
def test_commands_of_the_data_set_are_understood(command):
    assert dataset._parser().parse_args(shlex.split(command)[3:])


@pytest.mark.parametrize("command", shown(r"python -m camp\.deploy \S"))
def test_commands_of_the_bare_loop_are_understood(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert deploy.main(shlex.split(command)[3:]) == 2
    assert "policy.onnx: not found" in capsys.readouterr().err


@pytest.mark.parametrize("command", shown(r"python -m camp\.go2\S* \S"))
def test_commands_of_the_robots_interface_are_understood(command):
    module, *arguments = shlex.split(command)[2:]
    assert {"camp.go2": go2, "camp.go2_sim": go2_sim}[module]._parser().parse_args(arguments)


@pytest.mark.parametrize("command", shown(r"python -m (camp\.(export|play|ship|replay|transfer)|analysis)"))
def test_keys_of_small_commands_are_in_their_usage(command):
    module, *arguments = shlex.split(command)[2:]
    spec = find_spec(f"{module}.__main__" if module in ("analysis", "camp.play", "camp.transfer") else module)
    assert spec is not None and spec.origin is not None
    usage = Path(spec.origin).read_text(encoding="utf-8").split('"""')[1]
    for key in (argument.partition("=")[0] for argument in arguments if "=" in argument):
        assert f"{key}=<" in usage, command
