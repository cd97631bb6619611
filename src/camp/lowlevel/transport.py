"""What a controller and a robot need of whatever carries their messages."""

from __future__ import annotations

from typing import Protocol

from camp.lowlevel.messages import Command, Reading


class RobotLink(Protocol):
    """The controller's end."""

    @property
    def connected(self) -> bool:
        """Whether a robot is at the other end."""
        ...

    def receive(self) -> Reading | None:
        """The newest state that came since the last call; None where none came. Does not wait."""
        ...

    def send(self, command: Command) -> None:
        """Give the motors a command."""
        ...

    def rival(self) -> bool:
        """Whether somebody else's command was seen since the last call."""
        ...


class ControllerLink(Protocol):
    """The robot's end."""

    @property
    def connected(self) -> bool:
        """Whether a controller is at the other end."""
        ...

    def receive(self) -> Command | None:
        """The newest command that came since the last call; None where none came. Does not wait."""
        ...

    def send(self, reading: Reading) -> None:
        """Tell the robot's state."""
        ...


class SportMode(Protocol):
    """The robot's own controller, which commands the motors until it is released."""

    def active(self) -> str:
        """Its name; "" where it is released."""
        ...

    def release(self) -> None:
        """Ask it to leave the motors to others."""
        ...
