"""Expert motions on the command line.

python -m camp.dataset                       generate the shipped clips (those that are there are kept)
python -m camp.dataset validate [FOLDER]     check clips; exit code 1 if one is bad
python -m camp.dataset card [FOLDER]         write the folder's README.md from its clips; exit code 1 if one is bad
python -m camp.dataset perturbed --folder F  clips with noisy targets and corrective labels, for imitation
python -m camp.dataset import FILE ...       another project's motion becomes a clip: --format, --gait (docs/motions.md)
python -m camp.dataset export CLIP ...       a clip in another project's format: --format amp OUTPUT

--robot NAME: whose motions, everywhere but for `export` (default: go2)
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from camp.common.errors import CampError, ClipError
from camp.common.paths import shipped_motions
from camp.motion.clips.clip import Clip
from camp.motion.clips.consistency import ClipCheck
from camp.motion.clips.store import load_clip
from camp.motion.dataset.card import dataset_card, write_card
from camp.motion.dataset.diagnose import find_cause
from camp.motion.dataset.generate import generate_dataset
from camp.motion.dataset.report import quality_table
from camp.motion.dataset.requests import ClipRequest, perturbed_requests, shipped_requests
from camp.motion.dataset.validate import check_clip
from camp.motion.exchange.cli import COMMANDS as EXCHANGE
from camp.motion.exchange.cli import add_exchange, run_exchange
from camp.robots.registry import DEFAULT_ROBOT, ROBOTS, find_robot
from camp.robots.robot import Robot

TABLE_WIDTH = 220  # characters, where the output is not a terminal


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, 1 for bad clips, 2 for input that cannot be used."""
    options = _parser().parse_args(arguments)
    try:
        robot = find_robot(options.robot, key="--robot")
        if options.command in EXCHANGE:
            return run_exchange(robot, options)
        options.folder = options.folder or _usual_folder(robot, options.command)
        if options.command == "validate":
            return validate(robot, options.folder)
        if options.command == "card":
            return card(robot, options.folder)
        if options.command == "perturbed":
            requests = perturbed_requests(options.count, options.seed)
            generate(robot, requests, options)
            return 0  # some perturbed robots fall: their clips are left out
        return int(generate(robot, _chosen(shipped_requests(robot), options.only), options) > 0)
    except CampError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _usual_folder(robot: Robot, command: str) -> Path:
    """Where a robot's clips lie, or those that show it recovering go."""
    return Path(f"outputs/motions/perturbed_{robot.name}") if command == "perturbed" else shipped_motions(robot.name)


def _chosen(requests: list[ClipRequest], pattern: str) -> list[ClipRequest]:
    """The requests whose names match. Raises ClipError where none does."""
    chosen = [request for request in requests if fnmatchcase(request.name, pattern)]
    if not chosen:
        raise ClipError(f"--only {pattern!r}: matches none of {len(requests)} clips, such as {requests[0].name}")
    return chosen


def generate(robot: Robot, requests: Sequence[ClipRequest], options: argparse.Namespace) -> int:
    """Generate clips with a progress bar; returns how many failed."""
    count = {"made": 0, "kept": 0, "failed": 0}
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns) as progress:
        task = progress.add_task("expert clips", total=len(requests))
        for outcome in generate_dataset(robot, requests, options.folder, options.workers, options.overwrite):
            count[outcome.status] += 1
            if outcome.status == "failed":
                progress.console.print(f"left out: {outcome.request.name}: {outcome.message}", soft_wrap=True)
            progress.update(task, advance=1, description=outcome.request.name)
    size = sum(path.stat().st_size for path in options.folder.glob("*.npz")) / 1e6
    print(f"{options.folder}: " + ", ".join(f"{n} {status}" for status, n in count.items()) + f", {size:.1f} MB")
    return count["failed"]


@dataclass(frozen=True)
class Judged:
    """A folder's clips and what the checks say, by name; `bad`: how many clips fail or cannot be read."""

    clips: dict[str, Clip]
    results: dict[str, list[ClipCheck]]
    bad: int


def validate(robot: Robot, folder: Path) -> int:
    """Print the quality of every clip in a folder; returns the exit code."""
    judged = judge(robot, folder)
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(quality_table(judged.results))
    print(f"{folder}: {len(clip_paths(folder))} clips, {judged.bad} bad")
    return int(judged.bad > 0)


def card(robot: Robot, folder: Path) -> int:
    """Write the folder's card; returns the exit code."""
    judged = judge(robot, folder)
    size = sum(path.stat().st_size for path in clip_paths(folder))
    print(write_card(folder, dataset_card(robot, judged.clips, judged.results, size)))
    return int(judged.bad > 0)


def judge(robot: Robot, folder: Path) -> Judged:
    """Check every clip of a folder; what is wrong is printed, with its likely cause."""
    clips, results, bad = {}, {}, 0
    for path in clip_paths(folder):
        try:
            clip = load_clip(path)
        except ClipError as error:
            bad += 1
            print(f"error: {error}", file=sys.stderr)
            continue
        clips[path.stem], results[path.stem] = clip, check_clip(robot, clip)
        failed = [str(check) for check in results[path.stem] if not check.passed]
        if failed:
            bad += 1
            reason = "; ".join(filter(None, [find_cause(robot, clip), *failed]))
            print(f"error: clip {path}: {reason}", file=sys.stderr)
    return Judged(clips, results, bad)


def clip_paths(folder: Path) -> list[Path]:
    """The clip files of a folder, sorted. Raises ClipError where there is none."""
    paths = sorted(folder.glob("*.npz"))
    if not paths:
        raise ClipError(f"no clips in {folder}; generate them with `python -m camp.dataset`")
    return paths


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m camp.dataset", description="Expert motions.")
    parser.set_defaults(command="generate")
    parser.add_argument("--only", default="*", help="of the clips those whose names match, such as 'trot_3hz_*'")
    _add_generation(parser, "the shipped clips of the robot")
    _add_robot(parser, DEFAULT_ROBOT)
    commands = parser.add_subparsers()
    check = commands.add_parser("validate", help="check the clips of a folder")
    check.add_argument("folder", type=Path, nargs="?", help="(default: the shipped clips of the robot)")
    check.set_defaults(command="validate")
    describe = commands.add_parser("card", help="write the data set's README.md from its clips")
    describe.add_argument("folder", type=Path, nargs="?", help="(default: the shipped clips of the robot)")
    describe.set_defaults(command="card")
    perturbed = commands.add_parser("perturbed", help="generate clips with noisy targets and corrective labels")
    perturbed.add_argument("--count", type=int, default=150, help="number of clips to try (some robots fall)")
    perturbed.add_argument("--seed", type=int, default=0, help="of commands and noise")
    _add_generation(perturbed, "outputs/motions/perturbed_<robot>")
    perturbed.set_defaults(command="perturbed")
    add_exchange(commands)
    for command in commands.choices.values():
        _add_robot(command, argparse.SUPPRESS)  # what stands before the command counts too
    return parser


def _add_robot(parser: argparse.ArgumentParser, default: str) -> None:
    parser.add_argument("--robot", default=default, help=f"one of {', '.join(ROBOTS)} (default: {DEFAULT_ROBOT})")


def _add_generation(parser: argparse.ArgumentParser, folder: str) -> None:
    parser.add_argument("--folder", type=Path, help=f"where the clips go (default: {folder})")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--overwrite", action="store_true", help="generate also what is there already")


if __name__ == "__main__":
    sys.exit(main())
