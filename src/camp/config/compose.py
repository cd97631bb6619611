"""Composing conf/ with overrides, the ablations included."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from hydra import compose, initialize_config_dir
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.global_hydra import GlobalHydra
from hydra.core.plugins import Plugins
from hydra.plugins.search_path_plugin import SearchPathPlugin

from camp.common.paths import ablation_root, config_root
from camp.config.renamed import renamed_overrides
from camp.config.resolve import resolve
from camp.config.schema import Config


class AblationSearchPath(SearchPathPlugin):
    """Lets `+ablation=<name>` find ablations/ablation/<name>.yaml, whatever the primary config."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        search_path.append("camp", f"file://{ablation_root()}")


def register_ablations() -> None:
    """Make the ablations known to Hydra; once is enough, more does no harm."""
    Plugins.instance().register(AblationSearchPath)


def compose_config(overrides: Sequence[str] = ()) -> Config:
    """conf/train.yaml with ``overrides``, typed and checked, outside of a Hydra command line.

    Raises Hydra's and OmegaConf's errors for overrides that do not fit, ConfigError for values out of range.
    """
    register_ablations()
    with composing(config_root()):
        return resolve(compose("train", overrides=renamed_overrides(overrides)))


@contextmanager
def composing(folder: Path) -> Iterator[None]:
    """Hydra's compose reads ``folder``; a command line that is under way goes on as if nothing had happened."""
    # Hydra knows only one composition at a time.
    under_way = GlobalHydra.instance().hydra
    GlobalHydra.instance().clear()
    try:
        with initialize_config_dir(str(folder), version_base="1.3"):
            yield
    finally:
        GlobalHydra.instance().hydra = under_way
