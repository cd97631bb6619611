"""Both ends over DDS, on Unitree's topics rt/lowcmd and rt/lowstate.

A (de)serialization costs Python up to a millisecond. Hence a reader keeps the newest message alone and is asked once
for each control step, instead of being called for each of the robot's 500 messages per second.
"""

from __future__ import annotations

import socket
from typing import Any

from cyclonedds.core import DDSException, Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from unitree_sdk2py.idl.unitree_go.msg.dds_ import LowCmd_, LowState_

from camp.common.errors import CampError
from camp.lowlevel.messages import Command, Reading
from camp.lowlevel.wire import CommandReader, CommandWriter, StateWriter, reading_of

COMMANDS, STATES = "rt/lowcmd", "rt/lowstate"
LARGEST_DOMAIN = 232  # higher ones have no ports

_CONFIGURATION = """<CycloneDDS><Domain Id="any"><General><Interfaces>
<NetworkInterface name="{}" priority="default" multicast="default"/>
</Interfaces></General></Domain></CycloneDDS>"""

# Best effort reads what every writer offers; a reliable writer suits every reader.
_NEWEST = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(1), Policy.IgnoreLocal.Participant)
_TO_ALL = Qos(Policy.Reliability.Reliable(duration(milliseconds=1)), Policy.History.KeepLast(1))


class Network:
    """This process in a DDS domain on one network interface. A process joins a domain once."""

    def __init__(self, interface: str, domain: int):
        """Raises CampError for an interface that the system does not have, or that DDS cannot use."""
        known = [name for _, name in socket.if_nameindex()]
        if interface not in known:
            raise CampError(f"--interface {interface!r}: no such network interface; choose one of {', '.join(known)}")
        if not 0 <= domain <= LARGEST_DOMAIN:
            raise CampError(f"--domain {domain}: choose 0 to {LARGEST_DOMAIN}; the robot's is 0")
        try:
            self._domain = Domain(domain, _CONFIGURATION.format(interface))
            self.participant = DomainParticipant(domain)
        except DDSException as error:
            raise CampError(
                f"--interface {interface!r}: DDS cannot use it ({error}); see that it is up and has an address"
            ) from error

    def reader(self, topic: str, kind: type, qos: Qos = _NEWEST) -> DataReader[Any]:
        """Reads a topic; by default its newest message, and none that this process wrote."""
        return DataReader(self.participant, Topic(self.participant, topic, kind), qos=qos)

    def writer(self, topic: str, kind: type, qos: Qos = _TO_ALL) -> DataWriter[Any]:
        """Writes a topic."""
        return DataWriter(self.participant, Topic(self.participant, topic, kind), qos=qos)


def taken(reader: DataReader[Any]) -> list[Any]:
    """What a reader holds, oldest first, without the invalid sample that tells of a writer's end."""
    found = []
    while samples := reader.take(1):
        found += [sample for sample in samples if not isinstance(sample, InvalidSample)]
    return found


class DdsRobotLink:
    """The controller's end."""

    def __init__(self, network: Network):
        self._states = network.reader(STATES, LowState_)
        self._others = network.reader(COMMANDS, LowCmd_)
        self._commands = network.writer(COMMANDS, LowCmd_)
        self._writer = CommandWriter()

    @property
    def connected(self) -> bool:
        return bool(self._states.get_matched_publications())

    def receive(self) -> Reading | None:
        messages = taken(self._states)
        return reading_of(messages[-1]) if messages else None

    def send(self, command: Command) -> None:
        self._commands.write(self._writer.message(command))

    def rival(self) -> bool:
        return bool(taken(self._others))


class DdsControllerLink:
    """The robot's end, for a simulated one."""

    def __init__(self, network: Network):
        self._commands = network.reader(COMMANDS, LowCmd_)
        self._states = network.writer(STATES, LowState_)
        self._reader, self._writer = CommandReader(), StateWriter()
        self.damaged = 0  # commands with a wrong checksum

    @property
    def connected(self) -> bool:
        return bool(self._commands.get_matched_publications())

    def receive(self) -> Command | None:
        messages = taken(self._commands)
        command = self._reader.command(messages[-1]) if messages else None
        self.damaged += bool(messages) and command is None
        return command

    def send(self, reading: Reading) -> None:
        self._states.write(self._writer.message(reading))
