"""Engines side by side: `python -m analysis.transfer [results=<folder>] [output=<file.png>]`.

Draws what `python -m camp.transfer` found, right walks by skill and the stride frequencies and velocity errors of every
walk, and prints the table of engines as Markdown. Results are read from outputs/transfer by default; the figure is
engines.png beside them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from analysis.style import INK, new_figure, save, skill_shades, style
from camp.cli.key_values import key_values, run_command
from camp.metrics.tracking import velocity_error
from camp.transfer.engine import ENGINES
from camp.transfer.results import Judged, Result, read_results
from camp.transfer.summary import frequency_ratios, markdown, ordered, skills_of

RESULTS, FIGURE = Path("outputs") / "transfer", "engines.png"
WIDTH, ROW, REST = 7.2, 0.3, 1.2  # inches: the figure's width, of each result, of titles and legend
SPREAD = 0.36  # of an engine's row, over which its skills' points lie
TOLERANCE = 0.15  # of the stride frequency, as the judge has it


def main(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises CampError where there are no results."""
    given = key_values(arguments, [], ["results", "output"])
    folder = Path(given.get("results", RESULTS))
    results = read_results(folder)
    print(markdown(results))
    print(f"wrote {save(draw_engines(results), Path(given.get('output', folder / FIGURE)))}")


def draw_engines(results: Sequence[Result]) -> Figure:
    """Three panels with a row for each result: right walks by skill, stride frequencies, velocity errors."""
    shown = ordered(results)
    with style():
        figure = new_figure((WIDTH, REST + ROW * max(len(shown), 4)))
        right, frequency, speed = figure.subplots(1, 3, sharey=True, width_ratios=(1.5, 1.2, 1.0))
        _draw_right(right, shown)
        _draw_points(frequency, shown, frequency_ratios)
        frequency.axvline(1.0, color=INK, linewidth=0.6)
        frequency.axvspan(1.0 - TOLERANCE, 1.0 + TOLERANCE, color=INK, alpha=0.06, linewidth=0)
        frequency.set_title("stride frequency")
        frequency.set_xlabel("measured / commanded")
        _draw_points(speed, shown, _errors)
        speed.set_xlim(left=0.0)
        speed.set_title("velocity error")
        speed.set_xlabel("m/s")
        speed.xaxis.set_major_locator(MultipleLocator(0.1))
        figure.legend(*frequency.get_legend_handles_labels(), loc="outside lower center", ncols=4, handletextpad=0.1)
    return figure


def _draw_right(axes: Axes, results: Sequence[Result]) -> None:
    """Right walks of all walks in each cell."""
    skills = skills_of(results)
    share = np.full((len(results), len(skills)), np.nan)
    for row, result in enumerate(results):
        for column, skill in enumerate(skills):
            walks = [walk for walk in result.walks if walk.skill == skill]
            if not walks:
                continue
            right, falls = sum(walk.right for walk in walks), sum(walk.fell_after_s is not None for walk in walks)
            share[row, column] = right / len(walks)
            fallen = f"\n{falls} fell" if falls else ""
            axes.text(column, row, f"{right}/{len(walks)}{fallen}", ha="center", va="center", fontsize=6.5)
    axes.imshow(share, cmap="RdYlGn", vmin=0.0, vmax=1.0, alpha=0.45, aspect="auto")
    axes.set_xticks(
        range(len(skills)),
        [skill.replace("_", " ") for skill in skills],
        rotation=60,
        ha="right",
        rotation_mode="anchor",
    )
    axes.set_yticks(range(len(results)), [_name(result, results) for result in results])
    axes.set_title("walks that are right")
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _name(result: Result, results: Sequence[Result]) -> str:
    title = ENGINES[result.engine].title.split(" (")[0].split(",")[0]
    who = [getattr(result, name) for name in ("robot", "policy") if len({getattr(one, name) for one in results}) > 1]
    return "\n".join([title, " ".join(who)]) if who else title


def _draw_points(axes: Axes, results: Sequence[Result], values: Callable[[list[Judged]], list[float]]) -> None:
    """A point for each upright walk, every skill at a height and in a shade of its own."""
    skills = skills_of(results)
    for place, (skill, colour) in enumerate(skill_shades(skills).items()):
        height = SPREAD * (2.0 * place / max(len(skills) - 1, 1) - 1.0)
        found = [
            (value, row + height)
            for row, result in enumerate(results)
            for value in values([walk for walk in result.walks if walk.skill == skill])
        ]
        x, y = np.array(found).reshape(-1, 2).T
        axes.scatter(x, y, s=9.0, color=[colour], linewidths=0.0, label=skill.replace("_", " "))
    for row in range(1, len(results)):
        axes.axhline(row - 0.5, color=INK, alpha=0.15, linewidth=0.6)
    axes.tick_params(axis="y", length=0)


def _errors(walks: Sequence[Judged]) -> list[float]:
    """Size of the planar velocity error of each upright walk, m/s."""
    pairs = [(walk.command, walk.velocity) for walk in walks if walk.velocity is not None]
    return [float(velocity_error(np.array(asked), np.array(reached)).linear) for asked, reached in pairs]


if __name__ == "__main__":
    sys.exit(run_command(main, sys.argv[1:], __doc__))
