"""Play with a run's policy in the browser: ``python -m camp.play run=<run folder or shipped policy> [key=<value>]``.

port=<number>  of the page (default: 8080); 0: any that is free
host=<address> that the page is served at (default: 127.0.0.1, this machine alone); 0.0.0.0: all networks

Buttons, sliders and keys choose skill and velocity, push, reset, pause and slow the robot down; the diagram shows when
its feet stand, and the gait measured from that (docs/play.md). Needs the extra `play`. Ctrl-C ends it.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import Event

from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.play.clock import Clock
from camp.play.game import Game
from camp.play.panel import Panel
from camp.play.scene import Scene
from camp.play.server import require_viser, served
from camp.play.session import Session

PORT, HOST = 8080, "127.0.0.1"


def play(arguments: Sequence[str]) -> None:
    """Carry out the command line, until Ctrl-C. Raises CampError before the page is there."""
    given = key_values(arguments, required=["run"], optional=["port", "host"])
    port, host = _port(given.get("port", str(PORT))), given.get("host", HOST)
    require_viser()
    session = open_session(Path(given["run"]))
    clock = Clock(session.robot.model.opt.timestep)
    with served(host, port) as server, _ended_by_signals() as stop:
        scene = Scene(server, session.robot)
        panel = Panel(server, session, clock, scene)
        shown = "localhost" if host in ("0.0.0.0", HOST) else host
        print(f"http://{shown}:{server.get_port()} in your browser; Ctrl-C ends it", flush=True)
        clock.paused = False  # time begins now
        Game(session, clock, scene, panel).run(stop.is_set)
    print("stopped")


def open_session(run: Path) -> Session:
    """The latest policy of a run folder, exported, on its robot. Raises CampError."""
    from camp.config.resolve import load_run_config  # torch, which takes a while; misspelt arguments need not wait
    from camp.deployment.export import policy_of_run

    return Session(policy_of_run(run), load_run_config(run).env.push.max_velocity_m_s)


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise ConfigError(f"port = {text}: give a number from 0 (any that is free) to 65535")
    return int(text)


@contextmanager
def _ended_by_signals() -> Iterator[Event]:
    """An event that Ctrl-C and `kill` set: the usual ends of a server, not errors."""
    stop = Event()
    before = {number: signal.signal(number, lambda *_: stop.set()) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


if __name__ == "__main__":
    sys.exit(run_command(play, sys.argv[1:], __doc__))
