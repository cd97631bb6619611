"""The shipped suites as configuration."""

from __future__ import annotations

from camp.evaluation.composing import compose_evaluation
from camp.evaluation.config import EvaluationConfig


def evaluation(*overrides: str) -> EvaluationConfig:
    """conf/evaluation/evaluate.yaml with overrides."""
    return compose_evaluation(overrides)
