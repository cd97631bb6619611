"""The service of the robot that turns its sport mode off: requests and answers over DDS, as Unitree's client has it."""

from __future__ import annotations

import json
import time
from typing import Any

from cyclonedds.core import Policy, Qos
from unitree_sdk2py.idl.unitree_api.msg.dds_ import (
    Request_,
    RequestHeader_,
    RequestIdentity_,
    RequestLease_,
    RequestPolicy_,
    Response_,
    ResponseHeader_,
    ResponseStatus_,
)

from camp.common.errors import CampError
from camp.lowlevel.dds import Network, taken

REQUESTS, RESPONSES = "rt/api/motion_switcher/request", "rt/api/motion_switcher/response"
CHECK_MODE, RELEASE_MODE = 1001, 1003
ANSWER_S = 1.0  # that an answer may take
ATTEMPTS = 10  # the first request may leave before the two sides have found each other
POLL_S = 0.01

_NOTHING: Any = []  # of binary data, whose annotation is no type of Python
_ALL = Qos(Policy.Reliability.Reliable(0), Policy.History.KeepAll)


class MotionSwitcher:
    """The controller's end of the service: the robot's `SportMode`."""

    def __init__(self, network: Network):
        self._requests = network.writer(REQUESTS, Request_, _ALL)
        self._responses = network.reader(RESPONSES, Response_, _ALL)

    def active(self) -> str:
        """Name of the mode that commands the motors; "" for none. Raises CampError where nobody answers."""
        try:
            name = json.loads(self._call(CHECK_MODE).data)["name"]
        except (ValueError, KeyError, TypeError) as error:
            raise CampError("motion switcher: its answer is not understood; release the sport mode by hand") from error
        return str(name)

    def release(self) -> None:
        """Raises CampError where nobody answers."""
        self._call(RELEASE_MODE)

    def _call(self, api: int) -> Response_:
        for _ in range(ATTEMPTS):
            number = time.monotonic_ns()
            header = RequestHeader_(RequestIdentity_(number, api), RequestLease_(0), RequestPolicy_(0, False))
            self._requests.write(Request_(header, "{}", _NOTHING))
            latest = time.monotonic() + ANSWER_S
            while time.monotonic() < latest:
                for response in taken(self._responses):
                    if response.header.identity.id == number:
                        return response
                time.sleep(POLL_S)
        raise CampError(
            f"motion switcher: no answer in {ATTEMPTS} attempts; check --interface and --domain, "
            "or give --no-sport-mode where there is none, as in Unitree's simulator"
        )


class MotionSwitcherService:
    """The robot's end, for a simulated one: its sport mode is on until it is released."""

    def __init__(self, network: Network, mode: str = "normal"):
        self._requests = network.reader(REQUESTS, Request_, _ALL)
        self._responses = network.writer(RESPONSES, Response_, _ALL)
        self.mode = mode

    def answer(self) -> None:
        """Answer the requests that came since the last call."""
        for request in taken(self._requests):
            identity, data = request.header.identity, ""
            if identity.api_id == CHECK_MODE:
                data = json.dumps({"form": "0", "name": self.mode})
            elif identity.api_id == RELEASE_MODE:
                self.mode = ""
            self._responses.write(Response_(ResponseHeader_(identity, ResponseStatus_(0)), data, _NOTHING))
