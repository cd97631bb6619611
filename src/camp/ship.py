"""A finished run as a policy to ship: ``python -m camp.ship run=<run folder> name=<name>``.

Writes the folder src/camp/assets/policies/<name>: a small run folder with the networks, their normalizers, the
configuration, the evaluation and the learning curve, but nothing to continue the training from. What reads run folders
reads it too. Evaluate the run first.

output=<folder>     in place of src/camp/assets/policies
minutes=<number>    wall-clock time of the whole training command, for the policy's card
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from camp.cli.key_values import key_values, run_command
from camp.common import checks
from camp.common.errors import ConfigError
from camp.common.paths import policies_root
from camp.deployment.package import ship_policy


def ship(arguments: Sequence[str]) -> None:
    """Carry out the command line."""
    given = key_values(arguments, required=["run", "name"], optional=["output", "minutes"])
    name, minutes = given["name"], given.get("minutes")
    if not all(character.isalnum() or character in "_-" for character in name):
        raise ConfigError(f"name = {name!r}: choose one of letters, digits, '_' and '-'")
    try:
        measured = None if minutes is None else float(minutes)
    except ValueError as error:
        raise ConfigError(f"minutes = {minutes!r}: give a number") from error
    if measured is not None:
        checks.positive("minutes", measured)
    folder = ship_policy(Path(given["run"]), Path(given.get("output", policies_root())) / name, measured)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    for path in files:
        print(f"{path.stat().st_size / 1e3:8.1f} kB  {path.relative_to(folder)}")
    print(f"wrote {folder}: {sum(path.stat().st_size for path in files) / 1e6:.2f} MB")


if __name__ == "__main__":
    sys.exit(run_command(ship, sys.argv[1:], __doc__))
