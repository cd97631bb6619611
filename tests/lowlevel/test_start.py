"""The robot is not taken over before it answers, lies where it would fall, and is nobody else's."""

from __future__ import annotations

import numpy as np
import pytest

from camp.common.errors import CampError
from camp.lowlevel import start
from camp.lowlevel.messages import Command, Reading
from camp.lowlevel.motion import FOLDED
from camp.lowlevel.start import take_over
from tests.lowlevel.rig import reading

STANDING = np.array([0.0, 0.9, -1.8] * 4, np.float32)


class Robot:
    """A link whose robot answers as it is told to."""

    connected = True

    def __init__(self, position=FOLDED, rival: bool = False):
        self.position, self.rivals = position, rival

    def receive(self) -> Reading | None:
        return None if self.position is None else reading(position=self.position)

    def send(self, command: Command) -> None:
        raise AssertionError("nothing may be commanded")

    def rival(self) -> bool:
        return self.rivals


class Sport:
    """A sport mode that gives way at the given release; never: 0."""

    def __init__(self, mode: str = "normal", obeys_at: int = 1):
        self.mode, self.left = mode, obeys_at

    def active(self) -> str:
        return self.mode

    def release(self) -> None:
        self.left -= 1
        self.mode = "" if self.left == 0 else self.mode


@pytest.fixture(autouse=True)
def no_waiting(monkeypatch):
    monkeypatch.setattr(start, "STATE_S", 0.02)
    monkeypatch.setattr(start, "SETTLE_S", 0.0)


def test_a_lying_robot_is_taken_over_after_its_sport_mode_is_released():
    sport = Sport(obeys_at=2)
    take_over(Robot(), sport, listen_s=0.02)
    assert not sport.active()


def test_a_robot_without_sport_mode_may_have_any_pose():
    take_over(Robot(STANDING), Sport(mode=""), listen_s=0.02)
    take_over(Robot(STANDING), None, listen_s=0.02)


@pytest.mark.parametrize(
    ("robot", "sport", "message"),
    [
        (Robot(position=None), Sport(), "no state of a robot"),
        (Robot(STANDING), Sport(), "lay it down with the remote first"),
        (Robot(), Sport(obeys_at=0), "still active after 5 releases"),
        (Robot(rival=True), Sport(), "another process commands the motors"),
        (Robot(rival=True), None, "another process commands the motors"),
    ],
)
def test_a_robot_that_is_not_ready_is_left_alone(robot, sport, message):
    with pytest.raises(CampError, match=message):
        take_over(robot, sport, listen_s=0.02)
