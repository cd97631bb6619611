"""The figure of engines side by side."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.transfer import draw_engines, main
from camp.common.errors import CampError
from camp.transfer.results import write_result
from tests.transfer.results import FAST, FELL, RIGHT, result


def test_every_upright_walk_is_a_point_and_every_skill_a_cell():
    figure = draw_engines([result("drake", RIGHT, FELL), result("mujoco", RIGHT, FAST, FAST)])
    right, frequency, speed = figure.axes
    assert [label.get_text() for label in right.get_yticklabels()] == ["MuJoCo", "Drake"]
    assert [text.get_text() for text in right.texts] == ["1/1", "0/2", "1/1", "0/1\n1 fell"]
    points = np.concatenate([np.asarray(one.get_offsets()) for one in frequency.collections])
    assert sorted(points[:, 0]) == pytest.approx([1.05, 1.05, 1.2, 1.2])
    assert sum(len(np.asarray(one.get_offsets())) for one in speed.collections) == 4


def test_several_policies_and_robots_are_told_apart():
    figure = draw_engines([result("dart", RIGHT), result("dart", RIGHT, policy="other")])
    assert [one.get_text() for one in figure.axes[0].get_yticklabels()] == ["DART\nmine", "DART\nother"]
    robots = draw_engines([result("dart", RIGHT), result("dart", RIGHT, robot="a1")])
    assert [one.get_text() for one in robots.axes[0].get_yticklabels()] == ["DART\ngo2", "DART\na1"]


def test_the_command_prints_markdown_and_writes_the_figure(tmp_path, capsys):
    write_result(tmp_path / "a.json", result("dart", RIGHT))
    main([f"results={tmp_path}"])
    printed = capsys.readouterr().out
    assert (
        "| go2 | mine | DART, Gazebo's default engine, dartpy 1.2, 1 ms | 1 | 100% 21-100 | 100% | 0 | 1.050 |"
        in printed
    )
    assert (tmp_path / "engines.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(CampError, match="holds no results"):
        main([f"results={tmp_path / 'none'}"])
