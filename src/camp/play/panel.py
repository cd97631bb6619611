"""Buttons, sliders and keys, and what they ask for; the diagram and the numbers."""

from __future__ import annotations

from collections.abc import Callable
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

from camp.gaits.gait import GAITS
from camp.gaits.skills import split_name
from camp.play.clock import Clock
from camp.play.colours import BUTTON, RIGHT, rgb
from camp.play.diagram import diagram
from camp.play.readout import readout
from camp.play.scene import Scene
from camp.play.session import Session
from camp.play.words import COMMANDS, skill_text

if TYPE_CHECKING:
    from viser import ViserServer

STEP = 0.05  # of the sliders, in the command's unit
START = 2 / 3  # of the fastest forward
SPEEDS = ("0.1", "0.25", "0.5", "1", "2")  # simulated seconds per second
SLOW, NORMAL = 0.25, 1.0
NUDGES = {  # keys: axis and number of steps
    "arrowup": (0, 1),
    "arrowdown": (0, -1),
    "q": (1, 1),
    "e": (1, -1),
    "arrowleft": (2, 1),
    "arrowright": (2, -1),
}

Order = Callable[[], object]


class Panel:
    """Everything but the picture. Orders wait until `obey`, so that the simulation sees them between two timesteps."""

    def __init__(self, server: ViserServer, session: Session, clock: Clock, scene: Scene):
        self._session, self._clock, self._scene = session, clock, scene
        self._gui: Any = server.gui
        self._orders: SimpleQueue[Order] = SimpleQueue()
        feet = self._gui.add_panel()
        with feet.add_tab("Feet"):
            self._readout = self._gui.add_html("")
            self._diagram = self._gui.add_html("")
        feet.float(x=15, y=-15, width=500)
        self._buttons = {skill: self._skill_button(skill) for skill in session.skills}
        self._sliders = [self._slider(axis) for axis in range(len(COMMANDS))]
        self._button("Push", "P", self._push, "the trunk, from the right and the left in turn")
        self._button("Reset", "R", session.reset, "stand the robot up at the start")
        self._pause = self._button("Pause", "space", self._toggle_pause, "let time stand still")
        self._speeds = self._gui.add_button_group("speed", SPEEDS, hint="simulated seconds per second; M: slow motion")
        self._speeds.on_click(lambda event: self._order(lambda: self._set_speed(float(event.target.value))))
        self._key("Slow motion", "M", lambda: self._set_speed(SLOW if clock.speed == NORMAL else NORMAL))
        self._key("Stand still", "X", self._halt)
        for key, (axis, steps) in NUDGES.items():
            name = f"{'more' if steps > 0 else 'less'} {COMMANDS[axis].title}"
            self._key(
                name, key if len(key) > 1 else key.upper(), lambda axis=axis, steps=steps: self._nudge(axis, steps)
            )
        self._choose(session.skills[0])
        self._sliders[0].value = round(self._sliders[0].max * START / STEP) * STEP
        self.obey()

    def obey(self) -> bool:
        """Carry out the orders that came since the last call; returns whether there were any."""
        any_order = False
        while not self._orders.empty():
            self._orders.get()()
            any_order = True
        return any_order

    def show(self) -> None:
        """Draw diagram and numbers anew."""
        self._readout.content = readout(self._session, self._clock)
        self._diagram.content = f'<div style="padding: 0 0.5em">{diagram(self._session)}</div>'

    def _order(self, order: Order) -> None:
        self._orders.put(order)

    def _key(self, name: str, key: str, order: Order) -> None:
        self._gui.add_command(name, hotkey=key).on_trigger(lambda _: self._order(order))

    def _button(self, name: str, key: str, order: Order, hint: str) -> Any:
        button = self._gui.add_button(name, hint=f"{hint}; key: {key}", color=rgb(BUTTON))
        button.on_click(lambda _: self._order(order))
        self._key(name, key, order)
        return button

    def _skill_button(self, skill: str) -> Any:
        place = self._session.skills.index(skill) + 1
        button = self._gui.add_button(skill_text(skill), hint=f"key: {place}" if place < 10 else None)
        button.on_click(lambda _: self._order(lambda: self._choose(skill)))
        if place < 10:
            self._key(skill_text(skill), str(place), lambda: self._choose(skill))
        return button

    def _slider(self, axis: int) -> Any:
        command = COMMANDS[axis]
        low, high = self._session.policy.metadata["command_range"][command.key]
        slider = self._gui.add_slider(
            f"{command.title}, {command.unit}", low, high, STEP, 0.0, hint=f"above 0: {command.positive}"
        )
        slider.on_update(lambda _: self._order(self._steer))
        return slider

    def _choose(self, skill: str) -> None:
        self._session.choose(skill)
        for name, button in self._buttons.items():
            gait = GAITS.get(split_name(name)[0])
            button.color = rgb(BUTTON if name != skill else RIGHT if gait is None else gait.colour)

    def _steer(self) -> None:
        self._session.steer([slider.value for slider in self._sliders])

    def _nudge(self, axis: int, steps: int) -> None:
        slider = self._sliders[axis]
        slider.value = min(max(round(slider.value + steps * STEP, 6), slider.min), slider.max)
        self._steer()

    def _halt(self) -> None:
        for slider in self._sliders:
            slider.value = 0.0
        self._steer()

    def _push(self) -> None:
        self._scene.show_push(self._session.push())

    def _toggle_pause(self) -> None:
        self._clock.paused = not self._clock.paused
        self._pause.label = "Go on" if self._clock.paused else "Pause"

    def _set_speed(self, speed: float) -> None:
        self._clock.speed = speed
