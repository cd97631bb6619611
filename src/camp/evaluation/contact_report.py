"""What a contact log shows: stretches of one gait, how each looks, and how long every switch took."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from pydantic import TypeAdapter
from rich.table import Table

from camp.common.errors import CampError
from camp.evaluation.cells import cell, table
from camp.evaluation.contact_log import FootLog
from camp.evaluation.contract import parse_skill
from camp.gaits.skills import performed
from camp.metrics.contact import debounced
from camp.metrics.criteria import RHYTHM_PERIOD_S, ContactLog, Limits, WalkReading, failures, read_walks
from camp.metrics.gait import NO_GAIT, measure_over_time, switch_time


@dataclass
class Stretch:
    """A time in which the gait does not change. What needs 2 s is None in a shorter one."""

    start_s: float
    end_s: float
    gait: str
    frequency_hz: float | None = None
    duty: list[float] | None = None  # FL, FR, RL, RR
    phase: list[float | None] | None = None  # strides behind FL
    flight_fraction: float | None = None
    touches_per_stride: float | None = None
    lifts: float | None = None  # fraction of the strides in which every foot lifts 2 cm; None without heights
    failed: list[str] | None = None  # criteria that it fails as this gait; [] for a gait that is right


@dataclass
class Switch:
    """A change of what was asked for; seconds is None where it was never completed."""

    at_s: float
    skill: str
    seconds: float | None


@dataclass
class ContactReport:
    """Everything that a log tells."""

    format: Literal[2]
    kind: Literal["contacts"]
    file: str
    seconds: float
    period_s: float
    stretches: list[Stretch]
    switches: list[Switch]
    skill: str | None  # that the log was to show
    failed: list[str] | None  # criteria that the whole log fails as that skill; [] where it is right


def judge_log(log: FootLog, file: str, skill: str | None = None, discard_s: float = 0.0) -> ContactReport:
    """Judge a log without its first ``discard_s`` s. Raises CampError for less than 2 s and for an unknown skill."""
    limits, first = Limits(), round(discard_s / log.period_s)
    if log.seconds - discard_s < limits.frequency_window_s:
        raise CampError(
            f"contact log {file}: holds {log.seconds:.2f} s, of which {discard_s:g} s are discarded; "
            f"leave {limits.frequency_window_s:g} s or more"
        )
    contact = log.contact[first:]
    height = None if log.height is None else log.height[first:]
    cut = FootLog(log.period_s, contact, height, None if log.skill is None else log.skill[first:])
    failed = None
    if skill is not None:
        try:
            wanted = parse_skill(skill)
        except ValueError as error:
            raise CampError(str(error)) from error
        failed = _failed(cut, 0, len(contact), wanted.gait, wanted.frequency_hz)
    return ContactReport(
        format=2,
        kind="contacts",
        file=file,
        seconds=round(cut.seconds, 6),
        period_s=log.period_s,
        stretches=_stretches(cut, discard_s),
        switches=_switches(cut, discard_s),
        skill=skill,
        failed=failed,
    )


def contact_json(report: ContactReport) -> str:
    """The report's file."""
    return TypeAdapter(ContactReport).dump_json(report, indent=2).decode() + "\n"


def contact_tables(report: ContactReport) -> list[Table]:
    """The report as printed."""
    headings = ("s", "Hz", "duty FL FR RL RR", "phase FL FR RL RR", "flight", "touches", "lifts", "fails")
    stretches = table(
        f"{report.file}: {report.seconds:g} s at {1 / report.period_s:.0f} Hz", ("from s", "gait"), headings
    )
    for part in report.stretches:
        stretches.add_row(
            f"{part.start_s:.2f}",
            part.gait,
            f"{part.end_s - part.start_s:.2f}",
            cell(part.frequency_hz, ".2f"),
            _row(part.duty),
            _row(part.phase),
            cell(part.flight_fraction, ".2f"),
            cell(part.touches_per_stride, ".2f"),
            cell(part.lifts, ".0%"),
            "-" if part.failed is None else ", ".join(part.failed) or "nothing",
        )
    shown: list[Table] = [stretches]
    if report.switches:
        switches = table("switches", ("at s", "to"), ("completed after s",))
        for switch in report.switches:
            switches.add_row(f"{switch.at_s:.2f}", switch.skill, cell(switch.seconds, ".2f"))
        shown.append(switches)
    if report.failed is not None:
        whole = table("the whole log", ("asked for",), ("right", "fails"))
        whole.add_row(report.skill, "no" if report.failed else "yes", ", ".join(report.failed) or "nothing")
        shown.append(whole)
    return shown


def _row(values: list[float] | list[float | None] | None) -> str:
    return "-" if values is None else " ".join(cell(value, ".2f") for value in values)


def _failed(log: FootLog, start: int, end: int, gait: str, frequency_hz: float | None) -> list[str]:
    reading = read_walks(_part(log, start, end))
    return [name for name, value in failures(reading, gait, frequency_hz).items() if value[0]]


def _part(log: FootLog, start: int, end: int) -> ContactLog:
    height = None if log.height is None else log.height[None, start:end]
    return ContactLog(log.contact[None, start:end], log.period_s, height, log.period_s)


def _labels(log: FootLog) -> tuple[np.ndarray, np.ndarray, float]:
    """Gait and frequency over time at about 50 Hz, and s between rows."""
    every = max(1, int(RHYTHM_PERIOD_S / log.period_s + 1e-6))
    period = every * log.period_s
    seen = measure_over_time(debounced(log.contact, log.period_s)[::every], period)
    return seen.label, seen.frequency_hz, period


def _stretches(log: FootLog, offset_s: float) -> list[Stretch]:
    label, _, period = _labels(log)
    bounds = [0, *(np.flatnonzero(label[1:] != label[:-1]) + 1).tolist(), len(label)]
    every, result = round(period / log.period_s), []
    for begin, end in pairwise(bounds):
        gait, first, last = str(label[begin]), begin * every, min(end * every, len(log.contact))
        start_s, end_s = (round(offset_s + row * log.period_s, 6) for row in (first, last))
        stretch = Stretch(start_s, end_s, gait)
        # A label changes in the middle of its window: half of it beside another gait is left out of what is measured.
        edge = round(Limits().label_window_s / 2 / log.period_s)
        first, last = first + edge * (begin > 0), last - edge * (end < len(label))
        if gait != NO_GAIT and (last - first) * log.period_s >= Limits().frequency_window_s + period:
            _measure(stretch, read_walks(_part(log, first, last)))
        result.append(stretch)
    return result


def _measure(stretch: Stretch, reading: WalkReading) -> None:
    """Fill in what a stretch of one gait shows."""
    stretch.frequency_hz = _number(reading.frequency_hz[0])
    stretch.duty = [round(float(value), 4) for value in reading.duty[0]]
    stretch.phase = [_number(value) for value in reading.phase[0]]
    stretch.flight_fraction = round(float(reading.flight[0]), 4)
    stretch.touches_per_stride = _number(reading.touches[0].mean())
    stretch.lifts = None if reading.lift is None else round(float(reading.lift[0]), 4)
    stretch.failed = [name for name, value in failures(reading, stretch.gait).items() if value[0]]


def _switches(log: FootLog, offset_s: float) -> list[Switch]:
    """One for each change of the skill asked for; those that are no gait of the judge's are left out."""
    if log.skill is None:
        return []
    label, frequency, period = _labels(log)
    every = round(period / log.period_s)
    asked = log.skill[::every]
    begins = np.flatnonzero(asked[1:] != asked[:-1]) + 1
    ends, result = [*begins[1:], len(asked)][: len(begins)], []
    for begin, end in zip(begins, ends, strict=True):
        name = str(asked[begin])
        try:
            wanted = parse_skill(name)
        except ValueError:
            continue
        shown = performed(label[:end], frequency[:end], [wanted]).tolist()
        seconds = switch_time(shown, wanted.name, int(begin), period)
        at = round(offset_s + begin * period, 6)
        result.append(Switch(at, name, None if np.isnan(seconds) else round(seconds, 6)))
    return result


def _number(value: float) -> float | None:
    return round(float(value), 4) if np.isfinite(value) else None
