"""Where camp's own files lie: beside the package in a wheel, in the repository in an editable install."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent


def repository_root() -> Path | None:
    """The source checkout this package is imported from, or None when it was installed from a wheel."""
    root = _PACKAGE.parent.parent
    return root if (root / "pyproject.toml").is_file() and _PACKAGE.parent.name == "src" else None


def _shipped(name: str) -> Path:
    root = repository_root()
    return _PACKAGE / name if root is None else root / name


def config_root() -> Path:
    """The folder of Hydra's primary configs and groups (conf/)."""
    return _shipped("conf")


def ablation_root() -> Path:
    """The search path whose folder `ablation/` is the group that `+ablation=<name>` chooses from."""
    return _shipped("ablations")


def assets_root() -> Path:
    """Data shipped inside the package: expert motions and trained policies."""
    return _PACKAGE / "assets"


def shipped_motions(robot: str) -> Path:
    """The folder of the expert motions of the robot of that name."""
    return assets_root() / "motions" / robot


def policies_root() -> Path:
    """The policies shipped inside the package, one small run folder each."""
    return assets_root() / "policies"
