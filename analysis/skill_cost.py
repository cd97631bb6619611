"""What more skills cost: parameters of CAMP's two discriminators against one discriminator for each skill.

The paper says of Multi-AMP that its overhead grows with the number of skills (Sec. II); here both are counted, with the
networks of a run's own configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from analysis.style import COLUMN, GRID, new_figure, style
from camp.algo.models import SkillEmbedding
from camp.algo.skill import SkillPrior
from camp.algo.style import StylePrior
from camp.config.schema import Config

NUMBERS = (1, 2, 4, 8, 12, 16)


@dataclass(frozen=True)
class SkillCost:
    """Parameters by number of skills. shared: conditional style and skill discriminator with their embedding;
    separate: one unconditional discriminator for each skill."""

    skills: tuple[int, ...]
    shared: list[int]
    separate: list[int]


def compute_cost(config: Config, numbers: Sequence[int] = NUMBERS) -> SkillCost:
    """Count what the priors of these networks would learn, for those numbers that their embedding has room for."""
    numbers = [number for number in numbers if number <= config.algo.embedding_size]
    shape, source = config.env.transition_shape(), torch.Generator().manual_seed(0)
    conditional = replace(config.algo.style, conditional=True, mismatch_fraction=0.0, replay_size=0)
    shared, separate = [], []
    for number in numbers:
        names, embedding = [str(n) for n in range(number)], SkillEmbedding(number, config.algo.embedding_size, source)
        style_prior = StylePrior(conditional, embedding, names, shape, source)
        skill_prior = SkillPrior(config.algo.skill, embedding, names, shape, source)
        alone = StylePrior(replace(conditional, conditional=False), embedding, names, shape, source)
        shared.append(sum(map(_parameters, (style_prior.network, skill_prior.network, embedding))))
        separate.append(number * _parameters(alone.network))
    return SkillCost(tuple(numbers), shared, separate)


def _parameters(network: torch.nn.Module) -> int:
    return sum(parameter.numel() for parameter in network.parameters())


def draw_cost(cost: SkillCost) -> Figure:
    """Millions of parameters over the number of skills."""
    with style():
        figure = new_figure((COLUMN, 2.3))
        axes = figure.subplots()
        lines = (
            ("CAMP: both discriminators", cost.shared, "o", "#0072B2"),
            ("one AMP discriminator for each", cost.separate, "s", "#D55E00"),
        )
        for label, values, mark, colour in lines:
            axes.plot(cost.skills, [value / 1e6 for value in values], f"{mark}-", color=colour, ms=3.5, label=label)
        axes.set(xlabel="skills", ylabel="parameters (millions)")
        axes.set_ylim(bottom=0.0)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.grid(color=GRID, linewidth=0.5)
        axes.set_axisbelow(True)
        axes.legend(loc="upper left")
    return figure
