"""Results side by side as a static page: ``python -m camp.leaderboard [<report or folder> ...] [output=<file>]``.

Reports are the JSON files of camp.judge and camp.evaluate. Without any: those in outputs/judge, and of the shipped
policies. The page is outputs/leaderboard/index.html by default; it needs neither a server nor a network.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.common.files import make_folder, write_text
from camp.common.paths import policies_root
from camp.evaluation.page import leaderboard_page
from camp.evaluation.report import Report, read_report
from camp.runs.folder import REPORT

RESULTS, PAGE = Path("outputs") / "judge", Path("outputs") / "leaderboard" / "index.html"


def leaderboard(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises CampError where there is nothing to show, or a file is no report."""
    places = [Path(a) for a in arguments if "=" not in a]
    given = key_values([a for a in arguments if "=" in a], required=[], optional=["output"])
    files = _files(places or [RESULTS, *sorted(p for p in policies_root().iterdir() if p.is_dir())])
    if not files:
        raise ConfigError("no reports: judge something first, such as `python -m camp.judge expert`")
    page = Path(given.get("output", PAGE))
    make_folder(page.parent)
    write_text(page, leaderboard_page([_read(path) for path in files]))
    print(f"wrote {page}: {len(files)} results")


def _files(places: Sequence[Path]) -> list[Path]:
    """Reports: files as given; of a folder its eval.json or, without one, all its JSON files of policies."""
    found: list[Path] = []
    for place in places:
        if place.is_dir():
            own = place / REPORT
            found += [own] if own.is_file() else sorted(place.glob("*.json"))
        elif place not in (RESULTS,):
            found.append(place)
    return found


def _read(path: Path) -> Report:
    return read_report(path, "judge it again, or leave it out")


if __name__ == "__main__":
    sys.exit(run_command(leaderboard, sys.argv[1:], __doc__))
