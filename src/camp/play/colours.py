"""Colours of the page, those of the static web page (web/src/colours.js)."""

from __future__ import annotations

LEG_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00")  # FL, FR, RL, RR: Okabe & Ito's
PUSH_COLOUR = "#b2182b"
INK, FAINT, LANE = "#17212b", "#5b6875", "#e6ebf0"  # texts, lesser texts, an empty lane
ASKED, OTHER = "#5b6875", "#a9b4bf"  # a gait asked for; one measured that was not
RIGHT, WRONG = "#00704f", "#a34400"  # words on whether the robot does what was asked for
BUTTON = "#868e96"  # a skill that is not chosen


def rgb(colour: str) -> tuple[int, int, int]:
    """ "#0072B2" as three numbers."""
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue
