"""The contact diagram as SVG: the gait that was asked for, the one measured, and when each foot stood."""

from __future__ import annotations

from collections.abc import Sequence

from camp.common.stretches import stretches
from camp.gaits.skills import split_name
from camp.metrics.gait import NO_GAIT
from camp.play.colours import ASKED, FAINT, INK, LANE, LEG_COLOURS, OTHER, PUSH_COLOUR
from camp.play.session import Session
from camp.play.words import spoken
from camp.robots.quadruped import FOOT_NAMES

SHOWN_S = 4.0
WIDTH, LEFT, LANE_HEIGHT, GAP = 460, 76, 16, 4  # pixels; LEFT: of the names
AXIS = 16  # pixels below the lanes
NARROWEST_NAMED = 44  # pixels of a bar that a gait's name fits into


def diagram(session: Session) -> str:
    """An <svg> element of the latest SHOWN_S; the present is at the right edge."""
    steps = round(SHOWN_S / session.period_s)
    rows = list(session.moments)[-steps:]
    first = steps - len(rows)  # column of the earliest row
    asked = [split_name(row.skill)[0] for row in rows]
    measured = [row.gait for row in rows]
    parts = [_lane(0, "asked for"), _lane(1, "measured")]
    parts += _gaits(0, first, steps, [(gait, ASKED) for gait in asked])
    parts += _gaits(
        1,
        first,
        steps,
        [(gait, INK if gait == wanted else OTHER) for gait, wanted in zip(measured, asked, strict=True)],
    )
    contacts = session.contacts()[-steps:]
    for leg, (foot, colour) in enumerate(zip(FOOT_NAMES, LEG_COLOURS, strict=True)):
        parts.append(_lane(2 + leg, foot))
        stances = (stretch for stretch in stretches(contacts[:, leg].tolist()) if stretch[2])
        parts += [_bar(2 + leg, first + begin, first + end, steps, colour) for begin, end, _ in stances]
    parts += [_push(first + place, steps) for place, row in enumerate(rows) if row.pushed]
    parts += [_tick(ago) for ago in range(int(SHOWN_S) + 1)]
    height = _top(2 + len(FOOT_NAMES)) + AXIS
    return (
        f'<svg viewBox="0 0 {WIDTH} {height}" width="100%" font-family="system-ui, sans-serif" font-size="11" '
        f'font-weight="600" role="img" aria-label="contact diagram">{"".join(parts)}</svg>'
    )


def _top(lane: int) -> int:
    return lane * (LANE_HEIGHT + GAP)


def _x(column: float, steps: int) -> float:
    return LEFT + (WIDTH - LEFT) * column / steps


def _lane(lane: int, name: str) -> str:
    top = _top(lane)
    return (
        f'<text x="0" y="{top + 12}" fill="{INK}">{name}</text>'
        f'<rect x="{LEFT}" y="{top}" width="{WIDTH - LEFT}" height="{LANE_HEIGHT}" fill="{LANE}"/>'
    )


def _bar(lane: int, begin: int, end: int, steps: int, colour: str) -> str:
    x = _x(begin, steps)
    width = _x(end, steps) - x
    return f'<rect x="{x:.1f}" y="{_top(lane)}" width="{width:.1f}" height="{LANE_HEIGHT}" fill="{colour}"/>'


def _gaits(lane: int, first: int, steps: int, rows: Sequence[tuple[str, str]]) -> list[str]:
    """Bars of the gaits' stretches, each with its name where that fits. rows: gait and colour."""
    parts = []
    for begin, end, (gait, colour) in stretches(rows):
        if gait == NO_GAIT:
            continue
        parts.append(_bar(lane, first + begin, first + end, steps, colour))
        x = _x(first + begin, steps)
        if _x(first + end, steps) - x >= NARROWEST_NAMED:
            parts.append(f'<text x="{x + 5:.1f}" y="{_top(lane) + 12}" fill="#fff">{spoken(gait)}</text>')
    return parts


def _push(column: int, steps: int) -> str:
    height = _top(2 + len(FOOT_NAMES))
    return f'<rect x="{_x(column, steps):.1f}" y="0" width="3" height="{height}" fill="{PUSH_COLOUR}"/>'


def _tick(ago: int) -> str:
    anchor = "end" if ago == 0 else "start" if ago == SHOWN_S else "middle"
    x, y = WIDTH - (WIDTH - LEFT) * ago / SHOWN_S, _top(2 + len(FOOT_NAMES)) + 11
    text = "now" if ago == 0 else f"{ago} s ago"
    return f'<text x="{x:.1f}" y="{y}" fill="{FAINT}" font-weight="400" text-anchor="{anchor}">{text}</text>'
