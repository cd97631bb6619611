"""Walk in another engine: ``python -m camp.transfer <policy.onnx or run folder> engine=<name> [key=<value> ...]``.

engine=<name>       sapien, dart or drake (pip install -e '.[sim2sim]' -c constraints.txt), mujoco, or all
skills=<name,name>  of the policy's (default: all)
robot=<name>        that walks (default: the one that the policy was trained for)
suite=<name>        whose fixed commands are walked: short (the default; 5 of 6 s) or full (13 of 8 s)
output=<folder>     of the results, a file for each robot, policy and engine (default: outputs/transfer)

Prints the table of all results in that folder. ``python -m camp.transfer table [output=<folder>]`` prints it anew;
``python -m analysis.transfer`` draws it. docs/transfer.md tells what is the same in all engines, and what is not.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.common.files import make_folder
from camp.deployment.loop import Policy
from camp.evaluation.composing import compose_evaluation
from camp.evaluation.contract import parse_skill
from camp.evaluation.suite import file_digest
from camp.robots.registry import find_robot
from camp.transfer.engine import ENGINES, find_engine
from camp.transfer.results import Plan, read_results, walk_all, write_result
from camp.transfer.summary import TABLE_WIDTH, tables

OUTPUT = Path("outputs") / "transfer"


def transfer(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises CampError."""
    words = [argument for argument in arguments if "=" not in argument or Path(argument).exists()]
    pairs = [argument for argument in arguments if argument not in words]
    if words == ["table"]:
        folder = Path(key_values(pairs, [], ["output"]).get("output", OUTPUT))
    elif len(words) == 1:
        given = key_values(pairs, ["engine"], ["robot", "skills", "suite", "output"])
        folder = Path(given.get("output", OUTPUT))
        walk_engines(Path(words[0]), given, folder)
    else:
        raise ConfigError("give one policy.onnx or run folder, and engine=<name>; or table; see --help")
    Console(width=TABLE_WIDTH).print(tables(read_results(folder)))


def walk_engines(place: Path, given: dict[str, str], folder: Path) -> None:
    """Walk in every engine that is asked for, and write the results. Raises CampError before the first walk."""
    names = list(ENGINES) if given["engine"] == "all" else [given["engine"]]
    for name in names:
        find_engine(name)
    robot = find_robot(given["robot"], "robot") if "robot" in given else None
    suite = compose_evaluation([f"suite={given.get('suite', 'short')}"])
    with TemporaryDirectory() as scratch:
        path = _exported(place, Path(scratch)) if place.is_dir() else place
        policy, digest = Policy(path), file_digest(path)
    robot = robot or find_robot(policy.metadata["robot"])
    skills = _skills(given.get("skills"), policy)
    make_folder(folder)
    title = (place if place.is_dir() else place.parent).resolve().name
    plan = Plan(policy, title, digest, robot, skills, suite)
    for name in names:
        print(f"{name}: {len(skills) * len(suite.commands)} walks of {suite.duration_s:g} s", flush=True)
        result = walk_all(plan, name)
        path = folder / f"{result.robot}_{title}_{name}.json"
        write_result(path, result)
        print(f"wrote {path}")


def _exported(run: Path, folder: Path) -> Path:
    """The policy of a run folder as ONNX."""
    from camp.deployment.export import export_policy  # torch, which a policy.onnx does not need

    return export_policy(run, folder).model


def _skills(given: str | None, policy: Policy) -> list[str]:
    skills = policy.metadata["skills"] if given is None else given.split(",")
    for skill in skills:
        policy.one_hot(skill)
        try:
            parse_skill(skill)
        except ValueError as error:
            raise ConfigError(str(error)) from error
    return list(skills)


if __name__ == "__main__":
    sys.exit(run_command(transfer, sys.argv[1:], __doc__))
