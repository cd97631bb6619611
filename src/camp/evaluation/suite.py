"""What a result was measured by: a suite's name holds exactly as long as its values do."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, fields
from pathlib import Path

from camp.evaluation.config import EvaluationConfig, SuiteConfig
from camp.evaluation.report import SuiteStamp
from camp.metrics.criteria import Limits
from camp.robots.robot import Robot

# Digest of the values, the gait criteria's limits and the robot's model behind each named suite, by robot. A test
# compares them with the files: a change of what is measured needs a new name here.
SUITES = {
    "v1": {"go2": "16c610e718590d52", "a1": "5acf8384814ccb32"},
    "short": {"go2": "e574727a364cdd12", "a1": "76c58e288750580c"},
}
CUSTOM = "custom"


def stamp(evaluation: EvaluationConfig, robot: Robot) -> SuiteStamp:
    """The suite of an evaluation; "custom" where a value or the robot's model differs from the named suite's."""
    found = SuiteStamp(
        name=evaluation.name,
        digest=values_digest(evaluation),
        thresholds=_digest(json.dumps(asdict(Limits()), sort_keys=True).encode()),
        model=file_digest(robot.model_path),
        seed=evaluation.seed,
        robot=robot.name,
    )
    if SUITES.get(found.name, {}).get(robot.name) != whole_digest(found):
        found.name = CUSTOM
    return found


def whole_digest(found: SuiteStamp) -> str:
    """One digest of everything that a suite fixes."""
    return _digest(" ".join((found.digest, found.thresholds, found.model)).encode())


def values_digest(evaluation: EvaluationConfig) -> str:
    """Digest of the suite's values, whatever else is configured."""
    values = {field.name: getattr(evaluation, field.name) for field in fields(SuiteConfig)}
    plain = {name: asdict(value) if hasattr(value, "__dataclass_fields__") else value for name, value in values.items()}
    if not any(plain["randomization"]["delay_s"]):  # suites were named before there was such a value
        del plain["randomization"]["delay_s"]
    return _digest(json.dumps(plain, sort_keys=True).encode())


def file_digest(path: Path) -> str:
    """Digest of a file's content."""
    return _digest(path.read_bytes())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]
