"""The simulated robot's loop: by the clock, or in lockstep with its controller."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from camp.lowlevel.messages import Command
from camp.lowlevel.plant import Plant
from camp.lowlevel.transport import ControllerLink

POLL_S = 0.0005
AGAIN_S = 0.2  # a state that nobody answers is sent anew: the first ones find no reader yet

Obeys = Callable[[], bool]  # answers the services; whether the motors listen to others' commands


def serve_real_time(plant: Plant, link: ControllerLink, obeys: Obeys, seconds: float) -> float:
    """A state for every physics step, as near to the clock as possible; returns how late it was at most, s."""
    timestep = plant.robot.timestep_s
    begin, most = time.monotonic(), 0.0
    while plant.now_s < seconds:
        command = link.receive()
        if obeys() and command is not None:
            plant.tell(command)
        plant.advance(timestep)
        reading = plant.listen()
        if reading is not None:
            link.send(reading)
        spare = begin + plant.now_s - time.monotonic()
        most = max(most, -spare)
        time.sleep(max(0.0, spare))
    return most


def serve_lockstep(plant: Plant, link: ControllerLink, obeys: Obeys, seconds: float, period_s: float) -> None:
    """A state, its answer, one control period; ends early where the controller has gone."""
    step = 0
    while plant.now_s < seconds:
        step += 1
        command = _ask(plant, link, obeys, step)
        if command is None:
            return
        plant.tell(command)
        plant.advance(period_s)


def _ask(plant: Plant, link: ControllerLink, obeys: Obeys, step: int) -> Command | None:
    """The answer to a state; None where the controller has gone."""
    reading, again, seen = plant.answer(step), 0.0, False
    while True:
        if time.monotonic() >= again:
            link.send(reading)
            again = time.monotonic() + AGAIN_S
        command = link.receive()
        if obeys() and command is not None and command.step == step:
            return replace(command, step=0)
        connected = link.connected
        if (seen or step > 1) and not connected:
            return None
        seen = connected
        time.sleep(POLL_S)
