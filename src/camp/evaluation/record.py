"""The evaluation in the run's W&B run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from camp.build import Run
from camp.config.resolve import as_yaml
from camp.evaluation.report import Report, as_plain
from camp.runs.wandb_run import RunIdentity, start_wandb

SECTIONS = (
    *("policies", "expert", "table_i", "switching", "tracking"),
    *("quality", "reference", "style", "robustness"),
)


def log_evaluation(run: Run, folder: Path, report: Report, videos: dict[str, Path]) -> None:
    """Log the videos, and the report's numbers in the summary, as the run's own ``logger`` settings say.

    Raises ConfigError.
    """
    config = run.config
    if config.logger.wandb_mode == "disabled":
        return
    identity = RunIdentity(folder, group=config.variant, tags=[f"seed{config.seed}"])
    record = start_wandb(identity, config.logger, as_yaml(config))
    try:
        import wandb  # takes a second, which a run without it need not wait for

        values = metrics(report)
        # Online the resumed run goes on behind its last step; offline each part begins at 0 unless it is told.
        step = None if config.logger.wandb_mode == "online" else run.iteration + 1
        pictures = {f"evaluation/video/{name}": wandb.Video(str(path), format="mp4") for name, path in videos.items()}
        if pictures:
            record.log(pictures, step=step)
        # In the summary alone, which tables of runs show; logged, each would be a panel of a single dot.
        record.summary.update(values)
    finally:
        record.finish()


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
