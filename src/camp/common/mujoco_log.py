"""MuJoCo's warnings, which it would otherwise append to MUJOCO_LOG.TXT in the working folder."""

from __future__ import annotations

import sys

import mujoco

UNSTABLE = "The simulation is unstable"  # how MuJoCo ends the line about a state that is not finite
_told: set[str] = set()


def no_log_file() -> None:
    """Print every warning of MuJoCo once, on stderr. Of unstable simulations nothing: whoever simulates judges the
    state, and counts them."""
    mujoco.set_mju_user_warning(_tell)


def _tell(text: str) -> None:
    if UNSTABLE not in text and text not in _told:
        _told.add(text)
        print(f"MuJoCo: {text}", file=sys.stderr, flush=True)
