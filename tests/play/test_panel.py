"""Buttons, sliders and keys ask the session for what they say, on a server that nobody has to look at."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from camp.play.clock import Clock
from camp.play.panel import Panel


class Handle(SimpleNamespace):
    """One thing of the page; `act` is what a person does to it."""

    def __init__(self, **properties: Any):
        super().__init__(**properties)
        self.listeners: list[Callable[[Any], object]] = []

    def listen(self, listener: Callable[[Any], object]) -> None:
        self.listeners.append(listener)

    on_click = on_update = on_trigger = listen

    def act(self, value: Any = None) -> None:
        if value is not None:
            self.value = value
        for listener in self.listeners:
            listener(SimpleNamespace(target=self))

    def __enter__(self) -> Handle:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def add_tab(self, name: str) -> Handle:
        return Handle(label=name)

    def float(self, **_: int) -> None:
        pass


class Page:
    """Stands in for viser's server and its gui."""

    def __init__(self) -> None:
        self.gui, self.named, self.keys = self, dict[str, Handle](), dict[str, Handle]()

    def add_panel(self) -> Handle:
        return Handle()

    def add_html(self, content: str) -> Handle:
        return Handle(content=content)

    def add_button(self, label: str, **properties: Any) -> Handle:
        return self.named.setdefault(label, Handle(label=label, **{"color": None} | properties))

    def add_button_group(self, label: str, options: tuple[str, ...], **_: Any) -> Handle:
        return self.named.setdefault(label, Handle(value=options[0]))

    def add_slider(self, label: str, low: float, high: float, step: float, value: float, **_: Any) -> Handle:
        return self.named.setdefault(label, Handle(min=low, max=high, step=step, value=value))

    def add_command(self, _: str, *, hotkey: str) -> Handle:
        assert hotkey not in self.keys, f"{hotkey} has two meanings"
        return self.keys.setdefault(hotkey, Handle())


class Picture:
    """Stands in for the scene."""

    def __init__(self) -> None:
        self.pushes: list[tuple[float, float]] = []

    def show_push(self, direction: tuple[float, float]) -> None:
        self.pushes.append(direction)


@pytest.fixture
def desk(session) -> SimpleNamespace:
    page, clock, picture = Page(), Clock(0.005), Picture()
    server: Any = page
    scene: Any = picture
    panel = Panel(server, session, clock, scene)
    return SimpleNamespace(page=page, clock=clock, picture=picture, panel=panel, session=session)


def chosen(page: Page, skill: str) -> bool:
    """Whether a button has another colour than all the others."""
    colours = [handle.color for handle in page.named.values() if hasattr(handle, "color")]
    return colours.count(page.named[skill].color) == 1


def test_it_begins_with_the_first_skill_at_two_thirds_of_the_fastest(desk):
    desk.panel.obey()
    desk.page.named["vx, m/s"].act()
    desk.panel.obey()
    assert (desk.session.skill, desk.session.command) == ("trot_2hz", pytest.approx([0.6, 0.0, 0.0]))
    assert chosen(desk.page, "Trot, 2 strides/s")


def test_orders_wait_until_they_are_obeyed(desk):
    desk.page.named["Pace, 3 strides/s"].act()
    assert desk.session.skill == "trot_2hz"
    assert desk.panel.obey() and not desk.panel.obey()
    assert desk.session.skill == "pace_3hz"
    assert chosen(desk.page, "Pace, 3 strides/s") and not chosen(desk.page, "Trot, 2 strides/s")


def test_digits_choose_the_skills_in_their_order(desk):
    for place, skill in enumerate(desk.session.skills[:9]):
        desk.page.keys[str(place + 1)].act()
        desk.panel.obey()
        assert desk.session.skill == skill


def test_sliders_cover_the_range_of_training_and_steer(desk):
    ranges = [(handle.min, handle.max) for handle in desk.page.named.values() if hasattr(handle, "step")]
    assert ranges == [(-0.4, 0.9), (-0.25, 0.25), (-0.6, 0.6)]
    desk.page.named["yaw, rad/s"].act(-0.3)
    desk.panel.obey()
    assert desk.session.command == pytest.approx([0.6, 0.0, -0.3])


@pytest.mark.parametrize(
    "key, command",
    [
        ("arrowup", [0.65, 0, 0]),
        ("arrowdown", [0.55, 0, 0]),
        ("Q", [0.6, 0.05, 0]),
        ("E", [0.6, -0.05, 0]),
        ("arrowleft", [0.6, 0, 0.05]),
        ("arrowright", [0.6, 0, -0.05]),
        ("X", [0, 0, 0]),
    ],
)
def test_keys_steer_and_move_the_sliders(desk, key, command):
    desk.page.keys[key].act()
    desk.panel.obey()
    assert desk.session.command == pytest.approx(command)
    sliders = [handle.value for handle in desk.page.named.values() if hasattr(handle, "step")]
    assert sliders == pytest.approx(command)


def test_keys_stop_at_the_end_of_the_range(desk):
    for _ in range(50):
        desk.page.keys["arrowup"].act()
    desk.panel.obey()
    assert desk.session.command[0] == desk.page.named["vx, m/s"].value == 0.9


@pytest.mark.parametrize("of", ["named", "keys"])
def test_push_reset_and_pause(desk, of):
    def act(name: str, key: str) -> None:
        getattr(desk.page, of)[name if of == "named" else key].act()
        desk.panel.obey()

    for _ in range(8):
        desk.session.tick()
    act("Push", "P")
    assert len(desk.picture.pushes) == 1
    act("Reset", "R")
    assert not desk.session.moments
    act("Pause", "space")
    assert desk.clock.paused and desk.page.named["Pause"].label == "Go on"
    act("Pause", "space")
    assert not desk.clock.paused and desk.page.named["Pause"].label == "Pause"


def test_speeds(desk):
    desk.page.named["speed"].act("0.5")
    desk.panel.obey()
    assert desk.clock.speed == 0.5
    for speed in (1.0, 0.25, 1.0):
        desk.page.keys["M"].act()
        desk.panel.obey()
        assert desk.clock.speed == speed


def test_numbers_and_diagram_are_drawn_anew(desk):
    desk.panel.show()
    assert 'data-skill="none"' in desk.panel._readout.content
    assert "<svg" in desk.panel._diagram.content
