"""Expert motions on the command line.

python -m camp.dataset                       generate the shipped clips (those that are there are kept)
python -m camp.dataset --only 'trot_*'       those of them whose name fits
python -m camp.dataset validate [FOLDER]     check clips, --all shows every value; exit code 1 if one is bad
python -m camp.dataset card [FOLDER]         write the folder's README.md from its clips; exit code 1 if one is bad
python -m camp.dataset perturbed --folder F  clips with noisy targets and corrective labels, for imitation
python -m camp.dataset import FILE ...       another project's motion becomes a clip: --format, --gait (docs/motions.md)
python -m camp.dataset export CLIP ...       a clip in another project's format: --format amp OUTPUT

--robot NAME: whose motions, everywhere but for `export` (default: go2)
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from rich.console import Console

from camp.cli.guard import guarded
from camp.common.arguments import Parser
from camp.common.commands import command
from camp.common.errors import ClipError
from camp.common.files import folder_lock
from camp.common.paths import shipped_motions
from camp.common.progress import track
from camp.motion.clips.clip import Clip
from camp.motion.clips.consistency import ClipCheck
from camp.motion.clips.store import load_clip
from camp.motion.dataset.card import dataset_card, write_card
from camp.motion.dataset.diagnose import find_cause
from camp.motion.dataset.generate import generate_dataset
from camp.motion.dataset.report import failure_table, quality_tables, worst_table
from camp.motion.dataset.requests import ClipRequest, perturbed_requests, shipped_requests
from camp.motion.dataset.validate import check_clip
from camp.motion.exchange.cli import COMMANDS as EXCHANGE
from camp.motion.exchange.cli import add_exchange, run_exchange
from camp.robots.registry import DEFAULT_ROBOT, ROBOTS, find_robot
from camp.robots.robot import Robot

MODULE = "camp.dataset"
MOST_CLIPS = 100_000  # of one seed: what tells the files' names apart
MOST_WORKERS = 1024  # each takes a process and its memory
SHIPPED = "the robot's shipped clips"  # what help texts call the usual folder
TABLE_WIDTH = 80  # characters, where the output is not a terminal

if __name__ == "__mp_main__":  # a process that generates: Ctrl-C is the parent's to deal with
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, 1 for bad clips, 2 for input that cannot be used."""
    return guarded(lambda: _run(_parser().parse_args(arguments)))


def _run(options: argparse.Namespace) -> int:
    robot = find_robot(options.robot, key="--robot")
    if options.command in EXCHANGE:
        return run_exchange(robot, options)
    options.folder = options.folder or _usual_folder(robot, options.command)
    if options.command == "validate":
        return validate(robot, options.folder, options.all)
    if options.command == "card":
        return card(robot, options.folder)
    if options.command == "perturbed":
        generate(robot, perturbed_requests(options.count, options.seed), options)
        return 0  # some perturbed robots fall: their clips are left out
    return int(generate(robot, _fitting(shipped_requests(robot), options.only), options) > 0)


def _usual_folder(robot: Robot, command: str) -> Path:
    """Where a robot's clips lie, or those that show it recovering go."""
    return Path(f"outputs/motions/perturbed_{robot.name}") if command == "perturbed" else shipped_motions(robot.name)


def _fitting(requests: Sequence[ClipRequest], pattern: str) -> list[ClipRequest]:
    """The requests whose name fits. Raises ClipError where none does."""
    found = [request for request in requests if fnmatchcase(request.name, pattern)]
    if not found:
        raise ClipError(f"--only {pattern!r}: fits no clip; their names are like {requests[0].name}")
    return found


def generate(robot: Robot, requests: Sequence[ClipRequest], options: argparse.Namespace) -> int:
    """Generate clips with a progress bar, after other processes that do so there; returns how many failed."""
    count = {"made": 0, "kept": 0, "failed": 0}
    with folder_lock(options.folder):
        outcomes = generate_dataset(robot, requests, options.folder, options.workers, options.overwrite)
        for outcome in track(outcomes, "expert clips", len(requests)):
            count[outcome.status] += 1
            if outcome.status == "failed":
                print(f"left out: {outcome.request.name}: {outcome.message}", flush=True)
    size = sum(path.stat().st_size for path in options.folder.glob("*.npz")) / 1e6
    print(f"{options.folder}: " + ", ".join(f"{n} {status}" for status, n in count.items()) + f", {size:.1f} MB")
    return count["failed"]


@dataclass(frozen=True)
class Judged:
    """A folder's clips and what the checks say, by name; `bad`: how many clips fail or cannot be read."""

    clips: dict[str, Clip]
    results: dict[str, list[ClipCheck]]
    bad: int


def validate(robot: Robot, folder: Path, show_all: bool = False) -> int:
    """Print what fails and the worst of each criterion, or every clip with `show_all`; returns the exit code."""
    judged = judge(robot, folder)
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    if any(not check.passed for checks in judged.results.values() for check in checks):
        console.print(failure_table(judged.results))
    if judged.results:
        console.print(worst_table(judged.results))
    for table in quality_tables(judged.results, console.width) if show_all else []:
        console.print(table)
    rest = "" if show_all else "; every clip's values: --all"
    print(f"{folder}: {len(clip_paths(robot, folder))} clips, {judged.bad} bad{rest}")
    return int(judged.bad > 0)


def card(robot: Robot, folder: Path) -> int:
    """Write the folder's card; returns the exit code. Raises ClipError where no clip can be read."""
    judged = judge(robot, folder)
    if not judged.clips:
        raise ClipError(f"no clip in {folder} can be read; see why with `{command(MODULE, 'validate', str(folder))}`")
    size = sum(path.stat().st_size for path in clip_paths(robot, folder))
    print(write_card(folder, dataset_card(robot, judged.clips, judged.results, size)))
    return int(judged.bad > 0)


def judge(robot: Robot, folder: Path) -> Judged:
    """Check every clip of a folder; what is wrong is printed, with its likely cause."""
    clips, results, bad = {}, {}, 0
    for path in track(clip_paths(robot, folder), "judging clips"):
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


def clip_paths(robot: Robot, folder: Path) -> list[Path]:
    """The clip files of a folder, sorted. Raises ClipError where there is none."""
    paths = sorted(folder.glob("*.npz"))
    if not paths:
        words = ("--robot", robot.name, "--folder", str(folder))
        raise ClipError(f"no clips in {folder}; generate them with `{command(MODULE, *words)}`")
    return paths


def _whole(lowest: int, largest: int) -> Callable[[str], int]:
    """A reader of whole numbers within bounds."""

    def read(text: str) -> int:
        if not text.isascii() or not text.isdigit() or not lowest <= int(text[:20]) <= largest:
            raise argparse.ArgumentTypeError(f"{text[:20]!r}: pass a whole number from {lowest} to {largest}")
        return int(text)

    return read


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="python -m camp.dataset", description="Expert motions.")
    parser.set_defaults(command="generate")
    parser.add_argument(
        "--only", metavar="PATTERN", default="*", help="the clips whose name fits, such as 'trot_2hz_*'"
    )
    _add_generation(parser, SHIPPED)
    _add_robot(parser, DEFAULT_ROBOT)
    commands = parser.add_subparsers()
    check = commands.add_parser("validate", help="check the clips of a folder")
    check.add_argument("folder", type=Path, nargs="?", help=f"(default: {SHIPPED})")
    check.add_argument("--all", action="store_true", help="also every clip with every criterion")
    check.set_defaults(command="validate")
    describe = commands.add_parser("card", help="write the data set's README.md from its clips")
    describe.add_argument("folder", type=Path, nargs="?", help=f"(default: {SHIPPED})")
    describe.set_defaults(command="card")
    perturbed = commands.add_parser("perturbed", help="generate clips with noisy targets and corrective labels")
    perturbed.add_argument(
        "--count", type=_whole(1, MOST_CLIPS), default=150, help="number of clips to try (some robots fall)"
    )
    perturbed.add_argument("--seed", type=_whole(0, MOST_CLIPS), default=0, help="seed of commands and noise")
    _add_generation(perturbed, "outputs/motions/perturbed_<robot>")
    perturbed.set_defaults(command="perturbed")
    add_exchange(commands)
    for single in commands.choices.values():
        _add_robot(single, argparse.SUPPRESS)  # what stands before the command counts too
    return parser


def _add_robot(parser: argparse.ArgumentParser, default: str) -> None:
    parser.add_argument("--robot", default=default, help=f"one of {', '.join(ROBOTS)} (default: {DEFAULT_ROBOT})")


def _add_generation(parser: argparse.ArgumentParser, folder: str) -> None:
    parser.add_argument("--folder", type=Path, help=f"output folder (default: {folder})")
    parser.add_argument(
        "--workers", type=_whole(1, MOST_WORKERS), default=os.cpu_count() or 1, help="number of processes"
    )
    parser.add_argument("--overwrite", action="store_true", help="also generate clips that exist already")


if __name__ == "__main__":
    sys.exit(main())
