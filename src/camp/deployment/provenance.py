"""The origin of a shipped policy: command, seed, steps, time, versions and a learning curve of bounded size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camp.common.commands import command
from camp.common.errors import CheckpointError
from camp.common.foreign import foreign_file, read_json
from camp.config.schema import Config
from camp.evaluation.report import Report
from camp.evaluation.tables import verdict_markdown
from camp.robots.registry import find_robot
from camp.runs.folder import IMITATION, METRICS, VERSIONS, resumed_at
from camp.runs.metrics import read_metrics

MAX_ROWS = 200  # of a shipped learning curve
DIGITS = 4  # significant ones of its values
PACKAGES = ("torch", "mujoco", "mujoco-warp", "warp-lang", "numpy", "quadprog")  # what results depend on most
COUNTERS = ("iteration", "steps", "imitation/epoch")  # kept whole, and not averaged
_TIMES = ("time/collect_s", "time/score_s", "time/policy_update_s", "time/prior_update_s")
_PLACES = ("output_dir=", "motion.perturbed_folder=", "motion.folder=", "hydra.", "logger.")

CARD = """\
# {name}

One policy for the {robot} with the skills {skills}. The folder is a small run folder
(docs/deployment.md): the networks and their normalizers, without anything to continue the training from.

| | |
|---|---|
| command | `{command}` |
| seed | {seed} |
| code | camp {camp}, commit {commit} |
| iterations | {iterations}{resumed} |
| environment steps | {steps:,} |
| wall-clock time | {time} |
| machine | {cpus} processors, {backend} simulator, {packages} |

Where the command names places of the machine or the logger, they are left out; `config.yaml` holds every value that was
in effect.

Judged by `python -m camp.evaluate`, suite {suite} (digest {digest}), docs/evaluation.md. The intervals are over
walks of this one policy; they say nothing about other seeds of the training.

{verdict}

| file | |
|---|---|
| `checkpoints/` | actor and skill discriminator with their normalizers |
| `config.yaml`, `versions.json` | configuration, and the versions that trained |
| `policy.json` | what a controller needs to know: joints, gains, observation |
| `eval.json`, `eval.npz` | the evaluation of exactly this policy |
| `metrics.jsonl`{imitation} | learning curve: {rows} rows, {span} |
"""


@dataclass(frozen=True)
class Provenance:
    """What a policy's card tells. versions: as the run's versions.json, shortened; seconds: spent in iterations,
    which leaves out set-up and warm start."""

    config: Config
    versions: dict[str, Any]
    resumed_at: list[int]
    iterations: int
    steps: int
    seconds: float
    rows: int  # of the run's metrics
    imitated: bool
    minutes: float | None  # of the whole command, where measured


def provenance(run: Path, iteration: int, config: Config, minutes: float | None) -> Provenance:
    """Read how the run folder's policy was made. Raises CheckpointError where the record is missing or broken."""
    path = run / VERSIONS
    with foreign_file(path, f"file {path}: missing or incomplete", "name a complete run folder", CheckpointError):
        versions = read_json(path.read_bytes())
        packages = versions["packages"]
        shortened = {key: versions[key] for key in ("camp", "git", "python", "cpu_count", "started")}
        shortened["packages"] = {name: packages[name] for name in PACKAGES if name in packages}
        shortened["command"] = _command(versions["command"])
    rows = read_metrics(run / METRICS)
    if not rows or rows[-1].get("steps") is None:
        raise CheckpointError(f"metrics {run / METRICS}: hold no iteration; train the run further")
    return Provenance(
        config=config,
        versions=shortened,
        resumed_at=resumed_at(run),
        iterations=iteration,
        steps=int(rows[-1]["steps"]),
        seconds=sum(row[key] for row in rows for key in _TIMES if row.get(key) is not None),
        rows=len(rows),
        imitated=(run / IMITATION).is_file() and config.algo.imitation.epochs > 0,
        minutes=minutes,
    )


def describe(name: str, made_by: Provenance, report: Report) -> str:
    """The policy's README."""
    config, versions, git = made_by.config, made_by.versions, made_by.versions["git"] or {}
    resumed = ", resumed at " + ", ".join(map(str, made_by.resumed_at)) if made_by.resumed_at else ""
    block = block_length(made_by.rows)
    whole = "" if made_by.minutes is None else f"{made_by.minutes:.1f} min, everything included; "
    return CARD.format(
        name=name,
        robot=find_robot(config.robot.name).title,
        skills=", ".join(skill.name for skill in config.motion.skill_set()),
        command=versions["command"],
        seed=config.seed,
        camp=versions["camp"],
        commit=git.get("commit", "unknown") + (" with changes" if git.get("dirty") else ""),
        iterations=made_by.iterations,
        resumed=resumed,
        steps=made_by.steps,
        time=f"{whole}{made_by.seconds / 60.0:.1f} min in these iterations",
        cpus=versions["cpu_count"],
        backend=config.sim.backend,
        packages=", ".join(f"{package} {version}" for package, version in versions["packages"].items()),
        suite=report.suite.name,
        digest=report.suite.digest,
        verdict=verdict_markdown(report.verdict),
        imitation=", `imitation.jsonl`" if made_by.imitated else "",
        rows=-(-made_by.rows // block),
        span="one for each iteration" if block == 1 else f"each the mean of {block} iterations",
    )


def block_length(rows: int) -> int:
    """Iterations that one row of a shipped learning curve stands for."""
    return max(1, -(-rows // MAX_ROWS))


def condensed(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """At most MAX_ROWS rows: blocks of as many iterations each, every value the mean over those that have it, and
    every histogram the mean of each of its fractions."""
    length = block_length(len(rows))
    return [rounded(_mean(rows[start : start + length])) for start in range(0, len(rows), length)]


def _mean(block: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for key in dict.fromkeys(key for row in block for key in row):
        values = [row[key] for row in block if row.get(key) is not None]
        merged[key] = None if not values else values[-1] if key in COUNTERS else np.mean(values, axis=0).tolist()
    return merged


def rounded(row: Mapping[str, Any]) -> dict[str, Any]:
    """Every value with DIGITS significant digits, the counters whole."""
    return {key: value if key in COUNTERS else _rounded(value) for key, value in row.items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(part) for part in value]
    return None if value is None else float(f"{value:.{DIGITS}g}")


def _command(argv: Sequence[str]) -> str:
    """The training command as it is typed, without arguments that only name places or the logger."""
    kept = [argument for argument in argv[1:] if not argument.lstrip("+").startswith(_PLACES)]
    return command("camp.train", *kept)
