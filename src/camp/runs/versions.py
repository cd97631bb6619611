"""The versions that a result depends on: code, packages, machine, command line."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from camp import __version__
from camp.common.paths import repository_root


def collect_versions() -> dict[str, Any]:
    """camp's version and git commit, Python, every installed package, platform, CPUs, command, time (UTC)."""
    return {
        "camp": __version__,
        "git": git_state(repository_root()),
        "python": platform.python_version(),
        "packages": dict(sorted(_packages())),
        "platform": platform.platform(),
        "cpu_count": os.cpu_count(),
        "command": sys.argv,
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _packages() -> set[tuple[str, str]]:
    # Half-removed packages leave a distribution without a name behind.
    return {(one.name, one.version) for one in metadata.distributions() if one.name}


def git_state(root: Path | None) -> dict[str, Any] | None:
    """The commit checked out at `root` and whether files differ from it; None outside a repository."""
    if root is None or not (root / ".git").exists():
        return None
    try:
        commit, status = (
            subprocess.run(
                ["git", "-C", str(root), *arguments], capture_output=True, text=True, check=True, timeout=10
            ).stdout.strip()
            for arguments in (["rev-parse", "HEAD"], ["status", "--porcelain"])
        )
    except (OSError, subprocess.SubprocessError):  # no git, no commit yet, a damaged repository
        return None
    return {"commit": commit, "dirty": bool(status)}
