"""Before the first command: a robot that answers, its sport mode released, and nobody else at its motors."""

from __future__ import annotations

import time

from camp.common.errors import CampError
from camp.lowlevel.messages import Reading
from camp.lowlevel.transport import RobotLink, SportMode

STATE_S = 10.0  # that the first state may take
LISTEN_S = 1.0  # for somebody else's commands; the sport mode sends 500 per second
RELEASES = 5
SETTLE_S = 1.0  # after a release, as Unitree's example waits
POLL_S = 0.01
FOLDED_CALF = -2.0  # rad: further bent in every leg, the robot lies


def take_over(link: RobotLink, sport_mode: SportMode | None, listen_s: float = LISTEN_S) -> None:
    """Raises CampError where the robot is not ready, with what to do about it. Nothing is commanded.

    sport_mode: None where there is none, as in Unitree's simulator.
    """
    reading = _first_reading(link)
    if sport_mode is not None:
        _release(sport_mode, reading)
    latest = time.monotonic() + listen_s
    while time.monotonic() < latest:
        if link.rival():
            raise CampError("rt/lowcmd: another process commands the motors; end it (or its sport mode) first")
        time.sleep(POLL_S)


def _first_reading(link: RobotLink) -> Reading:
    latest = time.monotonic() + STATE_S
    while time.monotonic() < latest:
        reading = link.receive()
        if reading is not None:
            return reading
        time.sleep(POLL_S)
    raise CampError(
        f"rt/lowstate: no state of a robot in {STATE_S:g} s; check cable, --interface, the address of the interface "
        "(192.168.123.x) and --domain; `python -m camp.go2_sim --interface lo` is a simulated one"
    )


def _release(sport_mode: SportMode, reading: Reading) -> None:
    if not (name := sport_mode.active()):
        return
    if reading.joint_position[2::3].max() > FOLDED_CALF:
        raise CampError(
            f"sport mode {name!r} holds the robot up; it would fall when released: lay it down with the remote first"
        )
    for _ in range(RELEASES):
        sport_mode.release()
        if not (name := sport_mode.active()):
            return
        time.sleep(SETTLE_S)
    raise CampError(f"sport mode {name!r}: still active after {RELEASES} releases; turn it off in Unitree's app")
