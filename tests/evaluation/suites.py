"""The shipped suites as configuration, outside of a command line."""

from __future__ import annotations

from hydra import compose, initialize_config_dir
from hydra.core.global_hydra import GlobalHydra

from camp.evaluation.config import EvaluationConfig, resolve_evaluation
from camp.paths import config_root


def evaluation(*overrides: str) -> EvaluationConfig:
    """conf/evaluation/evaluate.yaml with overrides."""
    GlobalHydra.instance().clear()
    with initialize_config_dir(str(config_root() / "evaluation"), version_base="1.3"):
        return resolve_evaluation(compose("evaluate", overrides=["run=none", *overrides]))
