"""The structure of the package, read from its imports: layers, no circles, no stray modules."""

from __future__ import annotations

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import camp

ROOT = Path(camp.__file__).parent

# From the ground up. A module imports from lower layers and from its own package, never from its own layer's others.
LAYERS = (
    ("common",),
    ("robots", "data", "runs"),
    ("gaits", "sim"),
    ("metrics",),
    ("motion",),
    ("algo", "envs"),
    ("config",),
    ("build", "cli"),
    ("training", "evaluation", "single_env"),
    ("deployment",),
    ("lowlevel",),
    (
        *("train", "evaluate", "export", "deploy", "dataset", "ship", "bench", "judge", "leaderboard", "replay"),
        *("transfer", "go2", "go2_sim", "play"),
    ),
)
# Modules beside the packages that nobody needs to import: the commands, and Gymnasium's entry point.
ENTRY_POINTS = {*LAYERS[-1], "single_env"}


def modules() -> dict[str, Path]:
    """Every module of camp by its dotted name; a package's own is named as the package."""
    names = {}
    for path in ROOT.rglob("*.py"):
        parts = ("camp", *path.relative_to(ROOT).with_suffix("").parts)
        names[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return names


def imports() -> dict[str, set[str]]:
    """What each module imports of camp, wherever in its text."""
    known = modules()
    found: dict[str, set[str]] = {}
    for name, path in known.items():
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        plain = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
        for node in nodes:
            if isinstance(node, ast.ImportFrom) and node.module:
                full = {f"{node.module}.{alias.name}" for alias in node.names}
                plain |= {one if one in known else node.module for one in full}
        found[name] = {one for one in plain if one in known and one not in ("camp", name)}
    return found


def part(module: str) -> str:
    """The package or the loose module that a dotted name belongs to."""
    return module.split(".")[1]


def test_every_module_has_a_layer():
    placed = [name for layer in LAYERS for name in layer]
    assert len(placed) == len(set(placed))
    assert {part(name) for name in modules() if name != "camp"} == set(placed)


def test_imports_run_downwards():
    layer = {name: number for number, names in enumerate(LAYERS) for name in names}
    upward = [
        f"{module} imports {imported}"
        for module, those in imports().items()
        for imported in those
        if module != "camp" and part(module) != part(imported) and layer[part(module)] <= layer[part(imported)]
    ]
    assert not upward


def test_no_modules_import_each_other_in_a_circle():
    try:
        TopologicalSorter(imports()).prepare()
    except CycleError as circle:
        pytest.fail(" -> ".join(circle.args[1]))


def test_a_module_beside_the_packages_serves_several_of_them():
    loose = {path.stem for path in ROOT.glob("*.py")} - {"__init__"} - ENTRY_POINTS
    importers = {
        name: {part(module) for module, those in imports().items() if f"camp.{name}" in those} for name in loose
    }
    assert not {name: those for name, those in importers.items() if len(those) < 2}


@pytest.mark.parametrize("command", ["camp.deploy", "camp.go2", "camp.go2_sim"])
def test_what_runs_on_a_robots_computer_needs_no_torch(command):
    """Nothing that it imports, directly or not, may import torch."""
    found, reached, waiting = imports(), set(), [command]
    while waiting:
        module = waiting.pop()
        if module not in reached:
            reached.add(module)
            waiting += [*found[module], *(".".join(module.split(".")[:n]) for n in range(2, module.count(".") + 1))]
    for module in reached:
        text = modules()[module].read_text(encoding="utf-8")
        assert not any(line.lstrip().startswith(("import torch", "from torch")) for line in text.splitlines()), module


def test_only_the_registry_knows_the_robots_one_by_one():
    """Whoever needs a robot's numbers is given the robot; `camp.robots.registry` finds it by its name."""
    single = {f"camp.robots.{path.stem}" for path in (ROOT / "robots").glob("*.xml")}
    assert "camp.robots.go2" in single
    users = {module for module, those in imports().items() if those & single and part(module) != "robots"}
    assert not users
    within = {module for module, those in imports().items() if those & single} - single
    assert within == {"camp.robots.registry"}
