"""Foot-contact diagram of a sequence of skill switches (paper, Fig. 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.load import SwitchingSequence
from analysis.style import BAND, GAIT_COLOURS, INK, new_figure, skill_colours, style
from camp.common.stretches import stretches
from camp.evaluation.recording import Recording
from camp.metrics.contact import touchdowns
from camp.metrics.gait import NO_GAIT, label_over_time
from camp.robots.quadruped import FOOT_NAMES

WINDOW_S = 1.0  # of the measured gait


@dataclass(frozen=True)
class Span:
    """A stretch of time, s, that carries one name."""

    start_s: float
    end_s: float
    name: str


@dataclass(frozen=True)
class ContactDiagram:
    """stance: spans on the floor of FL, FR, RL, RR; commanded, measured: gaits, spans that fill the time.

    touches: of each foot per stance, 1 where none bounces; None where they were not recorded.
    """

    stance: tuple[list[Span], ...]
    commanded: list[Span]
    measured: list[Span]
    touches: tuple[float, ...] | None = None


def spans(values: list[str], period_s: float) -> list[Span]:
    """Runs of equal names, one name per control step."""
    return [Span(begin * period_s, end * period_s, name) for begin, end, name in stretches(values)]


def compute_diagram(sequence: SwitchingSequence, touches: tuple[float, ...] | None = None) -> ContactDiagram:
    """Turn rows of contacts into spans, and read the performed gait from a window centred on each step."""
    return ContactDiagram(
        stance=tuple(_stance(sequence.contact[:, foot], sequence.period_s) for foot in range(len(FOOT_NAMES))),
        commanded=spans([sequence.skills[i] for i in sequence.skill], sequence.period_s),
        measured=spans(label_over_time(sequence.contact, sequence.period_s, WINDOW_S), sequence.period_s),
        touches=touches,
    )


def diagram_of(recording: Recording, skills: tuple[str, ...]) -> ContactDiagram:
    """The diagram of a recording's first robot."""
    sequence = SwitchingSequence(recording.period_s, skills, recording.step_contact[0], recording.skill[0])
    return compute_diagram(sequence, touches_per_stance(recording.contact[0], recording.step_contact[0]))


def touches_per_stance(contact: NDArray[np.bool_], stance: NDArray[np.bool_]) -> tuple[float, ...]:
    """Touchdowns (T C, 4) as the sensors say over the stances (T, 4) without their breaks; nan for no stance."""
    touches, stances = touchdowns(contact), touchdowns(stance)
    return tuple(float(t / s) if s else float("nan") for t, s in zip(touches, stances, strict=True))


def draw_diagram(diagram: ContactDiagram) -> Figure:
    """Stance bars of each foot over the commanded skill's shade; below, a strip with the measured gait."""
    with style():
        figure = new_figure(BAND)
        feet, strip = figure.subplots(2, 1, sharex=True, height_ratios=(6, 1))
        _draw_feet(feet, diagram)
        _draw_measured(strip, diagram.measured)
        strip.set_xlabel("time (s)")
    return figure


def _draw_feet(axes: Axes, diagram: ContactDiagram) -> None:
    colour = skill_colours([span.name for span in diagram.commanded])
    for span in diagram.commanded:
        axes.axvspan(span.start_s, span.end_s, color=colour[span.name], alpha=0.22, linewidth=0)
        axes.text(
            (span.start_s + span.end_s) / 2,
            1.02,
            f"commanded: {span.name}" if span is diagram.commanded[0] else span.name,
            transform=axes.get_xaxis_transform(),
            ha="center",
            va="bottom",
            fontweight="bold",
            color=INK,
        )
    for span in diagram.commanded[1:]:
        axes.axvline(span.start_s, color=INK, linewidth=0.6, linestyle=(0, (3, 2)))
    for row, stance in enumerate(diagram.stance):
        axes.broken_barh(
            [(span.start_s, span.end_s - span.start_s) for span in stance],
            (row - 0.3, 0.6),
            facecolor=INK,
            linewidth=0,
        )
    axes.set_yticks(range(len(FOOT_NAMES)), FOOT_NAMES)
    axes.set_ylim(len(FOOT_NAMES) - 0.5, -0.5)
    axes.set_xlim(0.0, diagram.commanded[-1].end_s)
    axes.tick_params(axis="x", length=0, labelbottom=False)
    axes.tick_params(axis="y", length=0)
    if diagram.touches is not None:
        place = {"transform": axes.get_yaxis_transform(), "va": "center", "fontsize": 7}
        for row, touches in enumerate(diagram.touches):
            axes.text(1.01, row, f"{touches:.2f}", **place)
        axes.text(1.06, 1.5, "touches per stance", rotation=90, ha="left", **place)


def _draw_measured(axes: Axes, measured: list[Span]) -> None:
    for span in measured:
        axes.axvspan(span.start_s, span.end_s, color=GAIT_COLOURS[span.name], linewidth=0)
        if span.end_s - span.start_s > 0.5:
            middle = (span.start_s + span.end_s) / 2
            name = "no gait" if span.name == NO_GAIT else span.name
            axes.text(middle, 0.47, name, ha="center", va="center", fontsize=7, color=INK)
    axes.set_yticks([0.5], ["measured"])
    axes.set_ylim(0, 1)
    axes.tick_params(axis="y", length=0)


def _stance(contact: NDArray[np.bool_], period_s: float) -> list[Span]:
    names = np.where(contact, "stance", "swing").tolist()
    return [span for span in spans(names, period_s) if span.name == "stance"]
