"""The evaluation, and figures, in the run's W&B run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from camp.build import Run
from camp.config.resolve import as_yaml
from camp.evaluation.report import GaitSummary, Report, as_plain
from camp.runs.wandb_run import RunIdentity, start_wandb

SECTIONS = (
    *("policies", "expert", "table_i", "switching", "tracking"),
    *("quality", "reference", "style", "robustness"),
)
TABLE_COLUMNS = ("skill", "walks", "right", "low", "high", "falls", "stride Hz", "velocity error m/s")


def log_evaluation(run: Run, folder: Path, report: Report, videos: dict[str, Path]) -> None:
    """Log the videos, a table of the skills, and the report's numbers in the summary, as the run's own ``logger``
    settings say.

    Raises ConfigError.
    """
    with _continued(run, folder) as record:
        if record is None:
            return
        import wandb  # takes a second, which a run without it need not wait for

        shown: dict[str, Any] = {
            f"evaluation/video/{name}": wandb.Video(str(path), format="mp4") for name, path in videos.items()
        }
        if "trained" in report.policies:
            rows = table(report.policies["trained"].skills)
            shown["evaluation/skills"] = wandb.Table(columns=list(TABLE_COLUMNS), data=rows)
        if shown:
            record.log(shown, step=_step(run))
        # In the summary alone, which tables of runs show; logged, each would be a panel of a single dot.
        record.summary.update(metrics(report))


def log_figures(run: Run, folder: Path, figures: Mapping[str, Path]) -> None:
    """Log PNG files by their name, where the run's own ``logger`` settings have a W&B run. Raises ConfigError."""
    with _continued(run, folder) as record:
        if record is None:
            return
        import wandb

        record.log({f"figures/{name}": wandb.Image(str(path)) for name, path in figures.items()}, step=_step(run))


@contextmanager
def _continued(run: Run, folder: Path) -> Iterator[Any]:
    """The folder's W&B run, gone on with; None where its settings have none."""
    config = run.config
    if config.logger.wandb_mode == "disabled":
        yield None
        return
    identity = RunIdentity(folder, group=config.variant, tags=[f"seed{config.seed}"])
    record = start_wandb(identity, config.logger, as_yaml(config))
    try:
        yield record
    finally:
        record.finish()


def _step(run: Run) -> int | None:
    """Online the resumed run goes on behind its last step; offline each part begins at 0 unless it is told."""
    return None if run.config.logger.wandb_mode == "online" else run.iteration + 1


def table(skills: Mapping[str, GaitSummary]) -> list[Any]:
    """Rows of TABLE_COLUMNS."""
    rows: list[Any] = []
    for name, skill in skills.items():
        right = skill.gait_accuracy
        interval = [None, None, None] if right is None else [right.value, right.low, right.high]
        rows.append([name, skill.rollouts, *interval, skill.falls, skill.frequency_hz, skill.linear_error_m_s])
    return rows


def metrics(report: Report) -> dict[str, float]:
    """The numbers of a report by their path, such as ``evaluation/gait/trot/gait_accuracy``."""
    result, plain = {}, as_plain(report)
    for section in SECTIONS:
        result |= dict(_numbers(f"evaluation/{section}", plain[section]))
    for finding in report.verdict:
        name = finding.name.replace(", ", "_").replace("/", "_per_").replace(" ", "_")
        result[f"evaluation/verdict/{name}"] = float(finding.verdict == "shown")
    return result


def _numbers(path: str, value: Any):
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _numbers(f"{path}/{str(key).replace('/', '_per_').replace(' ', '_')}", inner)
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _numbers(f"{path}/{index}", inner)
    elif isinstance(value, int | float):
        yield path, float(value)
