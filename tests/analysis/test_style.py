"""The look is local and names keep their colours."""

from __future__ import annotations

import matplotlib as mpl

from analysis.style import GAIT_COLOURS, skill_colours, style


def test_settings_outside_are_untouched():
    before = mpl.rcParams["font.size"]
    with style():
        assert mpl.rcParams["font.size"] == 8.0
    assert mpl.rcParams["font.size"] == before


def test_a_gait_keeps_its_colour_at_every_frequency_and_other_skills_get_their_own():
    colours = skill_colours(["trot", "trot_2hz", "gallop", "walk"])
    assert colours["trot"] == colours["trot_2hz"] == GAIT_COLOURS["trot"]
    assert len({*GAIT_COLOURS.values(), colours["gallop"], colours["walk"]}) == len(GAIT_COLOURS) + 2
