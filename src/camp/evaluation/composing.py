"""The evaluation's configuration, outside of a Hydra command line."""

from __future__ import annotations

from collections.abc import Sequence

from hydra import compose, initialize_config_dir
from hydra.core.global_hydra import GlobalHydra

from camp.common.paths import config_root
from camp.evaluation.config import EvaluationConfig, resolve_evaluation


def compose_evaluation(overrides: Sequence[str] = ()) -> EvaluationConfig:
    """conf/evaluation/evaluate.yaml with ``overrides``, typed and checked; ``run`` need not be given.

    Raises Hydra's and OmegaConf's errors for overrides that do not fit, ConfigError for values out of range.
    """
    # A command line may be under way, and Hydra knows only one composition at a time.
    under_way = GlobalHydra.instance().hydra
    GlobalHydra.instance().clear()
    try:
        with initialize_config_dir(str(config_root() / "evaluation"), version_base="1.3"):
            return resolve_evaluation(compose("evaluate", overrides=["run=none", *overrides]))
    finally:
        GlobalHydra.instance().hydra = under_way
