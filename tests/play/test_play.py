"""The command: errors in one line, a page over HTTP, and an end by Ctrl-C."""

from __future__ import annotations

import signal
import socket
import sys
import urllib.request
from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np
import pytest

from camp.cli.key_values import run_command
from camp.play import __main__ as command
from camp.play.game import Game
from camp.play.scene import Scene
from camp.play.server import served
from tests.errors import assert_one_line
from tests.play.started import SHIPPED, started


@pytest.fixture
def taken() -> Iterator[int]:
    """A port at which somebody listens."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def fails(arguments: list[str], capsys: Any) -> str:
    assert run_command(command.play, arguments, command.__doc__) == 2
    return capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments, message",
    [
        ([], "argument run=<value> is missing: give run=<value> [port=<value>]"),
        (["run=x", "prot=1"], "did you mean port=?"),
        (["run=x", "port=many"], "port = many: give a number from 0"),
        (["run=x", "port=70000"], "port = 70000: give a number from 0"),
    ],
)
def test_arguments_are_checked_first(arguments, message, capsys):
    assert_one_line(fails(arguments, capsys), message)


def test_a_missing_package_is_told_with_its_extra(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    monkeypatch.setitem(sys.modules, "mjviser", None)
    assert_one_line(fails([f"run={SHIPPED}"], capsys), "install camp's extra `play`: pip install -e '.[play]'")


def test_a_folder_without_a_run_is_told(tmp_path, capsys):
    pytest.importorskip("mjviser", reason="comes with the play extra")
    assert_one_line(fails([f"run={tmp_path}"], capsys), str(tmp_path))


def test_a_port_that_is_taken_is_told(taken):
    pytest.importorskip("viser", reason="comes with the play extra")
    with (
        pytest.raises(command.ConfigError, match=rf"port = {taken}: .*give another one, or 0"),
        served("127.0.0.1", taken),
    ):
        pass


def test_an_address_of_another_machine_is_told():
    pytest.importorskip("viser", reason="comes with the play extra")
    with pytest.raises(command.ConfigError, match=r"port = 0: "), served("192.0.2.1", 0):
        pass


class ThreePictures:
    """Stands in for the panel: three turns, one order in the second."""

    def __init__(self) -> None:
        self.turns = 0

    def obey(self) -> bool:
        self.turns += 1
        return self.turns == 2

    def show(self) -> None:
        pass


def test_the_scene_shows_the_robot_above_the_floor_wherever_it_is(session):
    """Positions that the page gets are MuJoCo's, moved by the robot's place; the floor moves by whole squares."""
    pytest.importorskip("mjviser", reason="comes with the play extra")
    with served("127.0.0.1", 0) as server:
        scene = Scene(server, session.robot)
        data, model = session.robot.data, session.robot.model
        data.qpos[:2] = (3.3, -1.2)
        mujoco.mj_forward(model, data)
        scene.draw()
        base = model.body("base").id
        assert scene._bodies[base].position == pytest.approx([0.0, 0.0, data.qpos[2]])
        calf = model.body("FL_calf").id
        place = np.array([3.3, -1.2, 0.0])
        assert scene._bodies[calf].position == pytest.approx(data.xpos[calf] - place)
        assert np.array(scene._floor.position) == pytest.approx([0.7, 0.2, 0.0])  # 3.3 + 0.7 and -1.2 + 0.2 are whole
        scene.show_push((0.0, 1.0))
        assert scene._arrow.visible


def test_a_turn_simulates_for_as_long_as_the_clock_says(session):
    class Counter:
        ticks = 0
        paused = False

        def advance(self, tick: Any) -> None:
            self.ticks += 1
            tick()

    class Blank:
        drawn = 0

        def draw(self) -> None:
            self.drawn += 1

    clock, scene, panel = Counter(), Blank(), ThreePictures()
    game = Game(session, *([clock, scene, panel]))  # type: ignore[arg-type]
    game.run(lambda: panel.turns == 3)
    assert clock.ticks == 3 and scene.drawn >= 2  # at the beginning, and after the order


@pytest.mark.slow
def test_the_page_is_served_until_ctrl_c(tmp_path):
    pytest.importorskip("mjviser", reason="comes with the play extra")
    with started() as (process, address):
        with urllib.request.urlopen(address) as answer:
            assert answer.status == 200 and b"<title>Viser</title>" in answer.read()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    assert (process.returncode, out.strip(), err) == (0, "stopped", "")
