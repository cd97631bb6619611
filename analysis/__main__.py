"""`python -m analysis [run=<folder>] [only=<figure>,...] [wandb=<true, false or auto>]`: draw all figures of a run.

Each is a PDF and a PNG in <folder>/figures. Those of a shipped policy go into outputs/<its name>/figures. Without `run`
the newest evaluated run below outputs/ is taken. What lacks its input is left out, and a line says which command makes
it; the others are drawn. `only` draws some: data_flow, training, confusion, robustness, film_strip, contacts, joints,
clusters, dtw, dtw_expert, incentive, incentive_margins, skill_cost, or ablations (figures and Table IV of studies in
ablations/results). `wandb=true` logs them in the run's W&B run as well, `wandb=auto` where it has one.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from analysis import load
from analysis.gallery import FIGURES, STUDY_FIGURES, Sources, studies, tables
from analysis.style import save_both
from camp.cli.key_values import run_command
from camp.common.errors import CampError
from camp.common.files import make_folder, write_text
from camp.common.paths import policies_root
from camp.common.progress import phase
from camp.evaluation.record import log_figures
from camp.runs.folder import FIGURES as FOLDER
from camp.runs.folder import results_folder

ABLATIONS = "ablations"
Task = Callable[[], list[Path]]


def figures_folder(folder: Path) -> Path:
    """Where the run's figures go."""
    return results_folder(folder) / FOLDER


def run_folder(arguments: Sequence[str]) -> Path:
    """The folder of `run=<folder>`, or the newest evaluated run below outputs/ without arguments."""
    if not arguments:
        newest = load.newest_run(Path("outputs"))
        shipped = policies_root() / newest.name
        return shipped if shipped.is_dir() and results_folder(shipped) == newest else newest
    key, _, value = arguments[0].partition("=")
    if len(arguments) > 1 or key != "run" or not value:
        raise load.AnalysisError(f"cannot use '{' '.join(arguments)}': call `python -m analysis run=<folder>`")
    folder = Path(value)
    if not folder.is_dir():
        raise load.AnalysisError(f"run folder '{folder}' does not exist: pass one that camp.train wrote")
    return folder


def chosen(arguments: Sequence[str]) -> list[str]:
    """The names after only=, or all. Raises AnalysisError for one that does not exist."""
    known = [*FIGURES, ABLATIONS]
    only = [name for one in arguments if one.startswith("only=") for name in one.removeprefix("only=").split(",")]
    unknown = [name for name in only if name not in known]
    if unknown:
        raise load.AnalysisError(f"only={unknown[0]}: no such figure; choose from {', '.join(known)}")
    return only or known


def tasks(names: Sequence[str], sources: Sources, target: Path) -> Iterator[tuple[str, Task]]:
    """What is to be drawn, by name."""
    for name in names:
        if name != ABLATIONS:
            yield name, lambda name=name: save_both(FIGURES[name](sources), target, name)
            continue
        try:
            found = studies(sources.results)
        except CampError as error:
            yield ABLATIONS, _failing(error)
            continue
        for study in found:
            for kind, draw in STUDY_FIGURES.items():
                file = f"{study.study}_{kind}"
                yield file, lambda draw=draw, study=study, file=file: save_both(draw(study), target, file)
            yield f"{study.study}_tables", lambda study=study: _write_tables(study, target)


def _failing(error: CampError) -> Task:
    def fail() -> list[Path]:
        raise error

    return fail


def _write_tables(study, target: Path) -> list[Path]:
    paths = []
    for ending, text in tables(study).items():
        path = target / f"{study.study}_{ending}"
        write_text(path, text)
        paths.append(path)
    return paths


def draw_figures(arguments: Sequence[str]) -> None:
    """Draw the figures, a line for each. Raises CampError where none can be drawn."""
    names, wandb = chosen(arguments), wandb_wanted(arguments)
    folder = run_folder([one for one in arguments if not one.startswith(("only=", "wandb="))])
    sources = Sources(folder)
    logged = wandb != "false" and has_wandb(sources, wandb == "true")
    target = make_folder(figures_folder(folder))
    drawn: list[Path] = []
    last = None
    for name, task in tasks(names, sources, target):
        begun = time.perf_counter()
        try:
            with phase(f"drawing {name}", stream=sys.stderr):
                paths = task()
        except CampError as error:
            last = error
            print(f"{name} is left out: {error}", file=sys.stderr, flush=True)
            continue
        drawn += paths
        print(f"{' '.join(map(str, paths))} ({time.perf_counter() - begun:.1f} s)", flush=True)
    if last is not None and not drawn:
        raise load.AnalysisError(f"nothing was drawn: {last}")
    if logged:
        pictures = {path.stem: path for path in drawn if path.suffix == ".png"}
        log_figures(sources.run, folder, pictures)
        print(f"{len(pictures)} figures are in the W&B run of {folder}")


def wandb_wanted(arguments: Sequence[str]) -> str:
    """The value of wandb=, or "false". Raises AnalysisError for another one than true, false and auto."""
    values = [one.removeprefix("wandb=") for one in arguments if one.startswith("wandb=")] or ["false"]
    if len(values) > 1 or values[0] not in ("true", "false", "auto"):
        raise load.AnalysisError(f"wandb={values[0]}: give true, false or auto, once")
    return values[0]


def has_wandb(sources: Sources, needed: bool) -> bool:
    """Whether the run has a W&B run that could be gone on with. Raises AnalysisError where it is needed and is not."""
    reason = None
    if results_folder(sources.folder) != sources.folder:
        reason = "is a shipped policy, which has no W&B run"
    elif sources.run.config.logger.wandb_mode == "disabled":
        reason = "was trained without a W&B run"
    if reason and needed:
        raise load.AnalysisError(f"wandb=true: {sources.folder} {reason}; leave it out")
    return reason is None


def main(arguments: list[str]) -> int:
    """Draw the figures; returns the exit code, 2 where none could be drawn."""
    return run_command(draw_figures, arguments, __doc__)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
