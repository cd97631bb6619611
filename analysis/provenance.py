"""Where a committed result comes from."""

from __future__ import annotations

import platform
from pathlib import Path
from typing import Any

from camp.runs.versions import collect_versions

PACKAGES = ("torch", "mujoco", "numpy", "scikit-learn", "scipy")


def provenance() -> dict[str, Any]:
    """Machine, versions, commit and time, for a result's JSON."""
    versions = collect_versions()
    git = versions["git"] or {"commit": None, "dirty": None}
    return {
        "machine": {"platform": versions["platform"], "processor": processor(), "cpu_count": versions["cpu_count"]},
        "versions": {"python": versions["python"]} | {name: versions["packages"].get(name) for name in PACKAGES},
        "commit": git["commit"],
        "dirty": git["dirty"],
        "started": versions["started"],
    }


def processor() -> str:
    """The processor's name, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
