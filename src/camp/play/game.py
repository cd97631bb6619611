"""What goes on while the page is served: orders, time, picture and numbers in turn, in one thread."""

from __future__ import annotations

import time
from collections.abc import Callable

from camp.play.clock import Clock
from camp.play.panel import Panel
from camp.play.scene import Scene
from camp.play.session import Session

PICTURE_S, NUMBERS_S = 0.02, 0.1  # between two; numbers that change faster could not be read
REST_S = 0.001


class Game:
    """One session with its page."""

    def __init__(self, session: Session, clock: Clock, scene: Scene, panel: Panel):
        self._session, self._clock, self._scene, self._panel = session, clock, scene, panel

    def run(self, stopped: Callable[[], bool]) -> None:
        """Go on until ``stopped``. Raises CampError where the simulation diverges."""
        picture = numbers = time.monotonic()
        while not stopped():
            ordered = self._panel.obey()
            self._clock.advance(self._session.tick)
            now = time.monotonic()
            if self._clock.paused and not ordered:  # nothing moves
                time.sleep(PICTURE_S)
                continue
            if now >= picture or ordered:
                self._scene.draw()
                picture = max(picture + PICTURE_S, now)
            if now >= numbers or ordered:
                self._panel.show()
                numbers = max(numbers + NUMBERS_S, now)
            time.sleep(REST_S)
