"""Gait, stride frequency, velocities and real-time factor as HTML."""

from __future__ import annotations

from camp.metrics.gait import NO_GAIT
from camp.play.clock import Clock
from camp.play.colours import FAINT, RIGHT, WRONG
from camp.play.session import Session
from camp.play.words import COMMANDS, number, numbers, spoken

FALLEN = "The robot fell. Reset (R) stands it up."


def readout(session: Session, clock: Clock) -> str:
    """A <div> for the panel. What a program reads is in its data attributes."""
    measured = session.measured
    frequency = number(measured.frequency_hz)
    state = "paused" if clock.paused else "fallen" if session.fallen else "walking"
    velocity = numbers(measured.velocity)
    heads = "".join(f"<th>{command.title}, {command.unit}</th>" for command in COMMANDS)
    rows = "".join(
        f"<tr><td>{name}</td>{''.join(f'<td>{value}</td>' for value in values)}</tr>"
        for name, values in (("asked for", numbers(session.command)), ("measured", velocity))
    )
    return (
        f'<div id="readout" data-skill="{measured.skill}" data-frequency="{frequency}" data-vx="{velocity[0]}" '
        f'data-state="{state}" data-pushes="{session.pushes}" '
        f'style="padding: 0 0.5em; font-size: 0.9em; font-variant-numeric: tabular-nums">'
        f"<div><b>{_gait(measured.gait)}</b> {_verdict(session)}"
        f'<span style="float: right">{frequency} strides/s</span></div>'
        f'<table style="width: 100%; text-align: right"><tr style="color: {FAINT}"><th></th>{heads}</tr>{rows}</table>'
        f"<div>{_pace(clock)}</div>{_notice(session)}</div>"
    )


def _gait(gait: str) -> str:
    return "No gait" if gait == NO_GAIT else spoken(gait)


def _verdict(session: Session) -> str:
    if session.measured.gait == NO_GAIT:
        return ""
    right = session.measured.skill == session.skill
    text, colour = ("✓ as asked", RIGHT) if right else ("not (yet) as asked", WRONG)
    return f'<span style="color: {colour}">{text}</span>'


def _pace(clock: Clock) -> str:
    if clock.paused:
        return "paused"
    return f"real-time factor {clock.real_time_factor:.2f}, {clock.speed:.2f} asked for"


def _notice(session: Session) -> str:
    return f'<div style="color: {WRONG}"><b>{FALLEN}</b></div>' if session.fallen else ""
