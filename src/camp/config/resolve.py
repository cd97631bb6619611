"""From a composed or saved configuration to the typed and checked one, and back."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

from omegaconf import DictConfig, OmegaConf

from camp.common.errors import ConfigError
from camp.common.foreign import LARGEST_YAML, check_yaml, foreign_file
from camp.common.paths import config_root
from camp.config.hydra_errors import INPUT_ERRORS, diagnosis
from camp.config.renamed import renamed_overrides, with_new_names
from camp.config.schema import Config
from camp.runs.folder import CONFIG
from camp.sim.choice import AUTO, why_no_gpu
from camp.sim.config import check_backend

RESTORE = "restore the original file"


def resolve(config: DictConfig) -> Config:
    """The typed and checked configuration behind a composed one; ``sim=auto`` becomes what can run here.

    Raises an OmegaConf error for an unknown key or a wrong type, ConfigError for a value out of range; the command
    line prints either as one line.
    """
    composed = _with_simulator(without_hydra(config))
    typed = cast(Config, OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(Config), composed)))
    typed.check()
    return typed


def as_yaml(config: Config) -> DictConfig:
    """The typed configuration as OmegaConf, for the run folder."""
    return OmegaConf.structured(config)


def load_run_config(run: Path, changes: Sequence[str] = ()) -> Config:
    """The configuration a run folder was trained with, with ``changes`` like ``run.iterations=300``.

    A folder, which may be someone else's, never chooses to go online: that takes ``logger.wandb_mode=online`` among the
    changes. Raises ConfigError where there is none, or one that cannot be used; for ``changes`` as `resolve`.
    """
    path = run / CONFIG
    if not path.is_file():
        raise ConfigError(f"run folder {run}: holds no {CONFIG}; name one of the folders that camp.train wrote")
    saved = _load_yaml(path)
    if OmegaConf.select(saved, "logger.wandb_mode", throw_on_resolution_failure=False) == "online":
        saved.logger.wandb_mode = "offline"
    try:
        config = resolve(saved)
    except (*INPUT_ERRORS, TypeError) as error:  # OmegaConf lets a list pass for a number of a list
        raise ConfigError(
            f"file {path}: not a configuration for this camp ({diagnosis(error)}); restore the original file, or use "
            "the camp that wrote it, see versions.json"
        ) from error
    if not changes:
        return config
    return resolve(cast(DictConfig, OmegaConf.merge(saved, OmegaConf.from_dotlist(renamed_overrides(changes)))))


def _load_yaml(path: Path) -> DictConfig:
    with foreign_file(path, f"file {path}: cannot be read as YAML", RESTORE, ConfigError, LARGEST_YAML):
        text = path.read_text(encoding="utf-8")
        check_yaml(text)
        loaded = OmegaConf.create(text) if text.strip() else OmegaConf.create({})
    if not isinstance(loaded, DictConfig):
        raise ConfigError(f"file {path}: a list, not a configuration; {RESTORE}")
    _refuse_interpolations(path, OmegaConf.to_container(loaded, resolve=False))
    return with_new_names(loaded)


def _refuse_interpolations(path: Path, value: Any, key: str = "") -> None:
    """A file of others must not read this machine's environment: a saved configuration is resolved, all of it."""
    if isinstance(value, dict):
        for name, part in value.items():
            _refuse_interpolations(path, part, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            _refuse_interpolations(path, part, f"{key}[{index}]")
    elif isinstance(value, str) and "${" in value:
        raise ConfigError(f"file {path}: {key} = {value!r} is an interpolation; write the value itself")


def without_hydra(config: DictConfig) -> DictConfig:
    """A composed configuration without Hydra's own part."""
    return OmegaConf.create({key: config._get_node(key) for key in config if key != "hydra"})


def _with_simulator(config: DictConfig) -> DictConfig:
    """``config`` with the simulator chosen, where that is left to us, and the chosen one's values where none are
    given."""
    if not isinstance(config.get("sim"), DictConfig) or "backend" not in config.sim:
        return config
    backend = config.sim.backend
    if backend == AUTO:
        backend = "gpu" if why_no_gpu(config.device) is None else "cpu"
    check_backend(backend)
    given = {key: value for key, value in config.sim.items() if value is not None}
    values = OmegaConf.merge(OmegaConf.load(config_root() / "sim" / f"{backend}.yaml"), given, {"backend": backend})
    return OmegaConf.create({key: values if key == "sim" else config._get_node(key) for key in config})
