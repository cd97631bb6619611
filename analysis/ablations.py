"""Run a study of the ablations: `python -m analysis.ablations <study.yaml> [Hydra's launcher options]`.

For example `python -m analysis.ablations ablations/studies/reduced.yaml hydra/launcher=parallel`, or `make ablations`.
Every job is one training and its evaluation. What is done is skipped and what was cut off goes on from its last
checkpoint: give the same command again. The runs and their logs lie below outputs/studies/, the result goes to
ablations/results/. A run that the result on file has counts as done: machines may take turns at a study. Delete the
result to begin anew. With `collect=only` nothing is run and what is there is read.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from pathlib import Path

from omegaconf import DictConfig

from analysis.load import AnalysisError
from analysis.study import Job, Study, jobs_of, read_study
from analysis.study_results import collect, kept_runs, result_path, write_result
from analysis.study_runs import carry_out, runs_folder, state_of
from analysis.tables import ablation_table
from camp.cli.hydra_main import run_hydra
from camp.cli.key_values import run_command

ROOT = Path("outputs/studies")
USAGE = "python -m analysis.ablations <study.yaml> [hydra/launcher=parallel]"


def run_job(jobs: Sequence[Job], study: Study, runs: Path, composed: DictConfig) -> None:
    """What Hydra's launcher calls for each place in the list of jobs, perhaps in another process."""
    carry_out(jobs[composed.study_job], study, runs)


def run(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises CampError; SystemExit where a job failed."""
    if not arguments or not arguments[0].endswith((".yaml", ".yml")):
        raise AnalysisError(f"no study is given: call `{USAGE}`")
    unknown = [one for one in arguments[1:] if one != "collect=only" and not one.startswith("hydra")]
    if unknown:
        raise AnalysisError(f"argument {unknown[0]!r}: what is trained stands in the study's YAML; call `{USAGE}`")
    study = read_study(Path(arguments[0]))
    runs, jobs = runs_folder(study, ROOT), jobs_of(study)
    path = result_path(study.name)
    kept = kept_runs(study, path)
    open_jobs = [
        n for n, job in enumerate(jobs) if (job.arm, job.seed) not in kept and not state_of(job, runs).done(study)
    ]
    done = f"{len(jobs) - len(open_jobs)} of {len(jobs)} runs are done ({len(kept)} in {path})"
    print(f"{study.name}: {done}; runs below {runs}", flush=True)
    code = 0
    if open_jobs and "collect=only" not in arguments:
        task = functools.partial(run_job, jobs, study, runs.absolute())
        places = ",".join(map(str, open_jobs))
        code = run_hydra("train", task, ["-m", f"+study_job={places}", *arguments[1:]])
    result = collect(study, runs, kept_runs(study, path))  # read anew: another machine's may have come meanwhile
    if not result.runs:
        raise AnalysisError(f"study {study.name}: no run is done; give the command again to go on")
    write_result(path, result)
    print(ablation_table(result).as_markdown())
    print(f"wrote {path}; done: {len(result.runs)} of {len(jobs)} runs")
    if code:
        raise SystemExit(code)


if __name__ == "__main__":
    sys.exit(run_command(run, sys.argv[1:], __doc__))
