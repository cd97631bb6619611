"""Expert motions on the command line.

python -m camp.dataset                       generate the shipped clips (those that are there are kept)
python -m camp.dataset validate [FOLDER]     check clips; exit code 1 if one is bad
python -m camp.dataset perturbed --folder F  clips with noisy targets and corrective labels, for imitation
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from camp.errors import CampError, ClipError
from camp.motion.clips import load_clip
from camp.motion.generate import generate_dataset
from camp.motion.report import quality_table
from camp.motion.requests import ClipRequest, perturbed_requests, shipped_requests
from camp.motion.validate import check_clip
from camp.paths import assets_root

TABLE_WIDTH = 220  # characters, where the output is not a terminal


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, 1 for bad clips, 2 for input that cannot be used."""
    options = _parser().parse_args(arguments)
    try:
        if options.command == "validate":
            return validate(options.folder)
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


def validate(folder: Path) -> int:
    """Print the quality of every clip in a folder; returns the exit code."""
    paths = sorted(folder.glob("*.npz"))
    if not paths:
        raise ClipError(f"no clips in {folder}; generate them with `python -m camp.dataset`")
    results, bad = {}, 0
    for path in paths:
        try:
            results[path.stem] = check_clip(load_clip(path))
        except ClipError as error:
            bad += 1
            print(f"error: {error}", file=sys.stderr)
    console = Console() if sys.stdout.isatty() else Console(width=TABLE_WIDTH)
    console.print(quality_table(results))
    bad += sum(not all(check.passed for check in checks) for checks in results.values())
    print(f"{folder}: {len(paths)} clips, {bad} bad")
    return int(bad > 0)


def _parser() -> argparse.ArgumentParser:
    shipped = assets_root() / "motions" / "go2"
    parser = argparse.ArgumentParser(prog="python -m camp.dataset", description="Expert motions.")
    parser.set_defaults(command="generate")
    _add_generation(parser, shipped)
    commands = parser.add_subparsers()
    check = commands.add_parser("validate", help="check the clips of a folder")
    check.add_argument("folder", type=Path, nargs="?", default=shipped)
    check.set_defaults(command="validate")
    perturbed = commands.add_parser("perturbed", help="generate clips with noisy targets and corrective labels")
    perturbed.add_argument("--count", type=int, default=150, help="number of clips to try (some robots fall)")
    perturbed.add_argument("--seed", type=int, default=0, help="of commands and noise")
    _add_generation(perturbed, Path("outputs/motions/perturbed"))
    perturbed.set_defaults(command="perturbed")
    return parser


def _add_generation(parser: argparse.ArgumentParser, folder: Path) -> None:
    parser.add_argument("--folder", type=Path, default=folder, help="where the clips go (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--overwrite", action="store_true", help="generate also what is there already")


if __name__ == "__main__":
    sys.exit(main())
