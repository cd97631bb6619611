"""Command lines of argparse whose errors are one line."""

from __future__ import annotations

import argparse
from typing import NoReturn

from camp.common.errors import CampError


class Parser(argparse.ArgumentParser):
    """Raises CampError instead of printing four lines and leaving."""

    def error(self, message: str) -> NoReturn:
        """One line, for the command to print."""
        raise CampError(f"{message}; see --help")
