"""The evaluation's configuration, outside of a Hydra command line."""

from __future__ import annotations

from collections.abc import Sequence

from hydra import compose

from camp.common.paths import config_root
from camp.config.compose import composing
from camp.evaluation.config import EvaluationConfig, resolve_evaluation


def compose_evaluation(overrides: Sequence[str] = ()) -> EvaluationConfig:
    """conf/evaluation/evaluate.yaml with ``overrides``, typed and checked; ``run`` need not be given.

    Raises Hydra's and OmegaConf's errors for overrides that do not fit, ConfigError for values out of range.
    """
    with composing(config_root() / "evaluation"):
        return resolve_evaluation(compose("evaluate", overrides=["run=none", *overrides]))
