"""A study: which arms are trained with which seeds for how long, and by which thresholds the answer is Yes or No.

Its YAML is written before the first run:

    name: reduced                 # of its result, ablations/results/reduced.json
    question: what the study asks
    preset: [run=scratch]         # overrides that all arms share
    arms: [full, no_skill_obs]    # of ablations/ablation; a mapping gives an arm's own overrides
    seeds: [0, 1, 2]
    iterations: 300
    evaluation: [suite=short]     # overrides of camp.evaluate
    thresholds: {shown_fraction: 0.05, distinct_gaits: 4, information_bits: 1.0}
"""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path

import yaml
from pydantic import ConfigDict, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as checked

from camp.common.errors import ConfigError
from camp.common.foreign import first_problem
from camp.config.compose import compose_config
from camp.config.hydra_errors import INPUT_ERRORS, describe
from camp.config.schema import Config

_STRICT = ConfigDict(extra="forbid")


@checked(config=_STRICT)
class Thresholds:
    """When Table IV says Yes, by the mean over seeds and its interval.

    shown_fraction: of all walks from which on a gait counts as shown; distinct_gaits: shown, for "multiple gaits";
    information_bits: between commanded and shown gait, for "gait control switch".
    """

    shown_fraction: float
    distinct_gaits: float
    information_bits: float


@checked(config=_STRICT)
class Study:
    """See the module. arms: overrides by name; those of a name alone are its file in ablations/ablation."""

    name: str
    question: str
    preset: list[str]
    arms: dict[str, list[str]]
    seeds: list[int]
    iterations: int
    thresholds: Thresholds
    evaluation: list[str] = field(default_factory=list)

    @property
    def digest(self) -> str:
        """Of all that decides what a run is and how it is evaluated; seeds can be added, thresholds only judge."""
        decisive = {name: getattr(self, name) for name in ("preset", "arms", "iterations", "evaluation")}
        return hashlib.sha256(json.dumps(decisive, sort_keys=True).encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Job:
    """One training and its evaluation."""

    arm: str
    seed: int
    overrides: tuple[str, ...]


def read_study(path: Path) -> Study:
    """Read and check a study. Raises ConfigError in one line that names the file, the key and the remedy."""
    try:
        plain = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"study {path}: {error.strerror or error}; name a file of ablations/studies") from error
    except yaml.YAMLError as error:
        raise ConfigError(f"study {path}: no YAML ({' '.join(str(error).split())})") from error
    if isinstance(plain, dict) and isinstance(plain.get("arms"), list):
        plain["arms"] = {str(arm): [f"+ablation={arm}"] for arm in plain["arms"]}
    try:
        study = TypeAdapter(Study).validate_python(plain)
    except ValidationError as error:
        problem = first_problem(error, "the file")
        raise ConfigError(f"study {path}: {problem}; see analysis/study.py for an example") from error
    _check(study, path)
    return study


def _check(study: Study, path: Path) -> None:
    names = [study.name, *study.arms]
    bad = [name for name in names if not re.fullmatch(r"[a-z0-9_]+", name)]
    if bad:
        raise ConfigError(f"study {path}: name {bad[0]!r}: use small letters, digits and _")
    if not study.arms or not study.seeds or len(set(study.seeds)) < len(study.seeds):
        raise ConfigError(f"study {path}: arms and seeds: give one or more of each, each once")
    composed: dict[str, Config] = {}
    for arm in study.arms:
        try:
            composed[arm] = replace(compose_config(job_of(study, arm, study.seeds[0]).overrides), variant="")
        except INPUT_ERRORS as error:
            raise ConfigError(f"study {path}: arm {arm}: {describe(error)}") from error
    for one, other in combinations(study.arms, 2):
        if composed[one] == composed[other]:
            raise ConfigError(
                f"study {path}: arms {one} and {other} train the same; a value of the preset wins over one of an arm's "
                "file, so give it in the arm again, or take it out of the preset"
            )


def job_of(study: Study, arm: str, seed: int) -> Job:
    """The overrides of one training; the arm's name is the run's variant, whatever the arm is made of."""
    return Job(
        arm,
        seed,
        (
            *study.preset,
            *study.arms[arm],
            *(f"variant={arm}", f"seed={seed}", f"run.iterations={study.iterations}"),
            f"logger.wandb_tags=[{study.name}]",
        ),
    )


def jobs_of(study: Study) -> list[Job]:
    """All trainings, seed by seed, so that what is done first can be compared already."""
    return [job_of(study, arm, seed) for seed in study.seeds for arm in study.arms]
