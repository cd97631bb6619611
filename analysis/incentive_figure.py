"""The incentive study drawn: mean rewards of expert motion by what it shows and by its label, and the margins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.arms import title_of
from analysis.expert_priors import FAKES
from analysis.incentive import Incentive, margins
from analysis.matrices import Axis, Panel, Scale, draw_panels
from analysis.style import COLUMN, GRID, INK, TERM_COLOURS, new_figure, style

MARKS = {"style": "o", "skill": "s"}  # of the priors


def mean_reward(rows: Sequence[Incentive], arm: str, fakes: str) -> NDArray[np.floating]:
    """Weighted reward of both priors (K, K), mean over seeds."""
    chosen = [row for row in rows if (row.arm, row.fakes) == (arm, fakes)]
    return np.mean([np.array(row.style) + np.array(row.skill) for row in chosen], axis=0)


def draw_matrices(skills: list[str], rows: Sequence[Incentive], fakes: str = "blind") -> Figure:
    """A panel for each arm: shown skill by label."""
    arms = list(dict.fromkeys(row.arm for row in rows))
    values = {arm: mean_reward(rows, arm, fakes) for arm in arms}
    panels = [Panel(title_of(arm), matrix, skills, skills) for arm, matrix in values.items()]
    low, high = min(v.min() for v in values.values()), max(v.max() for v in values.values())
    axis = Axis("expert motion shown", "skill commanded")
    return draw_panels(panels, Scale(low, high, "weighted reward, style + skill"), axis)


def draw_margins(rows: Sequence[Incentive]) -> Figure:
    """Commanded skill less others, of each prior, every seed a mark; one panel for each kind of fakes."""
    arms = list(dict.fromkeys(row.arm for row in rows))
    found: Mapping[tuple[str, str, str], Any] = margins(rows)
    with style():
        figure = new_figure((COLUMN, 3.2))
        axes = figure.subplots(2, 1, sharex=True)
        for axis, fakes in zip(axes, FAKES, strict=True):
            axis.axvline(0.0, color=INK, linewidth=0.6)
            for offset, (prior, mark) in zip((-0.16, 0.16), MARKS.items(), strict=True):
                look = {"ms": 3, "color": TERM_COLOURS[prior], "alpha": 0.8}
                for place, arm in enumerate(arms):
                    values = found[arm, fakes, prior]
                    label = f"{prior} reward" if place == 0 else None
                    axis.plot(values, [place + offset] * len(values), mark, label=label, **look)
            axis.set_yticks(range(len(arms)), [title_of(arm) for arm in arms], fontsize=6.5)
            axis.set_ylim(len(arms) - 0.5, -0.5)
            axis.grid(axis="x", color=GRID, linewidth=0.5)
            axis.set_axisbelow(True)
            axis.set_title(f"fakes of a policy that is {fakes}", fontsize=8)
        axes[-1].set_xlabel("weighted reward: commanded less others")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure
