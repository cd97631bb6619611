"""A run's policy as ONNX: ``python -m camp.export run=<run folder or shipped policy> [output=<folder>]
[controller=<camp or unitree>]``.

Writes policy.onnx and policy.json; see docs/deployment.md. By default they go into the run folder, those of a
shipped policy into outputs/<its name>/. ``controller=unitree`` writes unitree/<skill>/ for each skill instead, as
Unitree's C++ controllers read it.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.deployment.export import CHECKED_OBSERVATIONS, TOLERANCE, export_policy
from camp.deployment.unitree import export_for_unitree
from camp.runs.folder import results_folder

CONTROLLERS = ("camp", "unitree")


def export(arguments: Sequence[str]) -> None:
    """Carry out the command line."""
    given = key_values(arguments, required=["run"], optional=["output", "controller"])
    run = Path(given["run"])
    output = Path(given["output"]) if "output" in given else results_folder(run)
    controller = given.get("controller", "camp")
    if controller not in CONTROLLERS:
        raise ConfigError(f"controller={controller}: choose {' or '.join(CONTROLLERS)}")
    if controller == "unitree":
        for folder in export_for_unitree(run, output / controller):
            print(f"wrote {folder}")
        return
    written = export_policy(run, output)
    print(f"wrote {written.model} and {written.metadata}")
    print(
        f"largest difference to torch on {CHECKED_OBSERVATIONS} random observations: {written.difference:.1e} rad "
        f"(allowed: {TOLERANCE:.0e})"
    )


if __name__ == "__main__":
    sys.exit(run_command(export, sys.argv[1:], __doc__))
