"""Expert motions on the command line.

python -m camp.dataset                       generate the shipped clips (those that are there are kept)
python -m camp.dataset validate [FOLDER]     check clips; exit code 1 if one is bad
python -m camp.dataset card [FOLDER]         write the folder's README.md from its clips; exit code 1 if one is bad
python -m camp.dataset perturbed --folder F  clips with noisy targets and corrective labels, for imitation
python -m camp.dataset import FILE ...       another project's motion becomes a clip: --format, --gait (docs/motions.md)
python -m camp.dataset export CLIP ...       a clip in another project's format: --format amp OUTPUT
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from camp.common.errors import CampError, ClipError
from camp.common.paths import assets_root
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

TABLE_WIDTH = 220  # characters, where the output is not a terminal


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, 1 for bad clips, 2 for input that cannot be used."""
    options = _parser().parse_args(arguments)
    try:
        if options.command == "validate":
            return validate(options.folder)
        if options.command == "card":
            return card(options.folder)
        if options.command in EXCHANGE:
            return run_exchange(options)
        if options.command == "perturbed":
            requests = perturbed_requests(options.count, options.seed)
            generate(requests, options)
            return 0  # some perturbed robots fall: their clips are left out
        return int(generate(shipped_requests(), options) > 0)
    except CampError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def generate(requests: Sequence[ClipRequest], options: argparse.Namespace) -> int:
    """Generate clips with a progress bar; returns how many failed."""
    count = {"made": 0, "kept": 0, "failed": 0}
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns) as progress:
        task = progress.add_task("expert clips", total=len(requests))
        for outcome in generate_dataset(requests, options.folder, options.workers, options.overwrite):
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


def validate(folder: Path) -> int:
    """Print the quality of every clip in a folder; returns the exit code."""
    judged = judge(folder)
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(quality_table(judged.results))
    print(f"{folder}: {len(clip_paths(folder))} clips, {judged.bad} bad")
    return int(judged.bad > 0)


def card(folder: Path) -> int:
    """Write the folder's card; returns the exit code."""
    judged = judge(folder)
    size = sum(path.stat().st_size for path in clip_paths(folder))
    print(write_card(folder, dataset_card(judged.clips, judged.results, size)))
    return int(judged.bad > 0)


def judge(folder: Path) -> Judged:
    """Check every clip of a folder; what is wrong is printed, with its likely cause."""
    clips, results, bad = {}, {}, 0
    for path in clip_paths(folder):
        try:
            clip = load_clip(path)
        except ClipError as error:
            bad += 1
            print(f"error: {error}", file=sys.stderr)
            continue
        clips[path.stem], results[path.stem] = clip, check_clip(clip)
        failed = [str(check) for check in results[path.stem] if not check.passed]
        if failed:
            bad += 1
            reason = "; ".join(filter(None, [find_cause(clip), *failed]))
            print(f"error: clip {path}: {reason}", file=sys.stderr)
    return Judged(clips, results, bad)


def clip_paths(folder: Path) -> list[Path]:
    """The clip files of a folder, sorted. Raises ClipError where there is none."""
    paths = sorted(folder.glob("*.npz"))
    if not paths:
        raise ClipError(f"no clips in {folder}; generate them with `python -m camp.dataset`")
    return paths


def _parser() -> argparse.ArgumentParser:
    shipped = assets_root() / "motions" / "go2"
    parser = argparse.ArgumentParser(prog="python -m camp.dataset", description="Expert motions.")
    parser.set_defaults(command="generate")
    _add_generation(parser, shipped)
    commands = parser.add_subparsers()
    check = commands.add_parser("validate", help="check the clips of a folder")
    check.add_argument("folder", type=Path, nargs="?", default=shipped)
    check.set_defaults(command="validate")
    describe = commands.add_parser("card", help="write the data set's README.md from its clips")
    describe.add_argument("folder", type=Path, nargs="?", default=shipped)
    describe.set_defaults(command="card")
    perturbed = commands.add_parser("perturbed", help="generate clips with noisy targets and corrective labels")
    perturbed.add_argument("--count", type=int, default=150, help="number of clips to try (some robots fall)")
    perturbed.add_argument("--seed", type=int, default=0, help="of commands and noise")
    _add_generation(perturbed, Path("outputs/motions/perturbed"))
    perturbed.set_defaults(command="perturbed")
    add_exchange(commands)
    return parser


def _add_generation(parser: argparse.ArgumentParser, folder: Path) -> None:
    parser.add_argument("--folder", type=Path, default=folder, help="where the clips go (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--overwrite", action="store_true", help="generate also what is there already")


if __name__ == "__main__":
    sys.exit(main())
