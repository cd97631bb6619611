"""A simulated Go2 behind the real one's low-level interface: the other side of camp.go2 (docs/go2.md).

    python -m camp.go2_sim --interface lo

MuJoCo obeys rt/lowcmd and answers with rt/lowstate, as Unitree's bridge does; the service that releases the sport mode
answers, too. Messages can be lost, delayed or fail for a while.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camp.common.arguments import Parser
from camp.common.errors import CampError
from camp.common.files import whole_file
from camp.lowlevel.conditions import Conditions
from camp.lowlevel.packages import require_dds
from camp.lowlevel.plant import Plant, Setup
from camp.lowlevel.serve import serve_lockstep, serve_real_time
from camp.lowlevel.simulated_robot import SimulatedRobot
from camp.robots.registry import find_robot

DOMAIN = 1  # of Unitree's simulator; a real robot has 0
CONTROL_PERIOD_S = 0.02  # of lockstep


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, or 2 for input that cannot be used."""
    try:
        return run(_parser().parse_args(arguments))
    except CampError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def run(options: argparse.Namespace) -> int:
    """Simulate. Raises CampError for input that cannot be used."""
    if not options.seconds > 0:
        raise CampError(f"--seconds {options.seconds:g}: give a time above 0")
    setup = Setup(_conditions(options, "command"), _conditions(options, "state"), options.watchdog, options.seed)
    require_dds()
    from camp.lowlevel.dds import DdsControllerLink, Network
    from camp.lowlevel.motion_switcher import MotionSwitcherService

    network = Network(options.interface, options.domain)
    link, switcher = DdsControllerLink(network), MotionSwitcherService(network)
    plant = Plant(SimulatedRobot(find_robot("go2")), setup)

    def obeys() -> bool:
        switcher.answer()
        return not switcher.mode

    print(f"simulated go2 on {options.interface}, domain {options.domain}", flush=True)
    if options.lockstep:
        serve_lockstep(plant, link, obeys, options.seconds, CONTROL_PERIOD_S)
    else:
        latest = serve_real_time(plant, link, obeys, options.seconds)
        print(f"physics behind the clock: {latest * 1e3:.1f} ms at most")
    print(
        f"after {plant.now_s:.2f} s: {plant.posture()}; commands {plant.commands.sent}, lost {plant.commands.lost}, "
        f"damaged {link.damaged}; states {plant.states.sent}, lost {plant.states.lost}"
        f"{'; the watchdog acted' if plant.watchdog.acted else ''}"
    )
    if options.record is not None:
        with whole_file(options.record) as file:
            np.savez(file, allow_pickle=False, **plant.record())
        print(f"wrote {options.record}")
    return 0


def _conditions(options: argparse.Namespace, direction: str) -> Conditions:
    at, length = getattr(options, f"{direction}_outage")
    loss, delay = getattr(options, f"{direction}_loss"), getattr(options, f"{direction}_delay")
    return Conditions(loss, delay, at, length)


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="python -m camp.go2_sim", description="Simulate a Go2 behind its low-level interface.")
    parser.add_argument("--interface", required=True, help="network interface; lo: controllers on this computer")
    parser.add_argument("--domain", type=int, default=DOMAIN, help="DDS domain (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=math.inf, help="of simulated time (default: without an end)")
    parser.add_argument("--lockstep", action="store_true", help="wait for the answer to each state, for tests")
    for direction in ("command", "state"):
        parser.add_argument(f"--{direction}-loss", type=float, default=0.0, metavar="SHARE", help="of the messages")
        parser.add_argument(f"--{direction}-delay", type=float, default=0.0, metavar="S", help="of every message")
        parser.add_argument(
            f"--{direction}-outage",
            type=float,
            nargs=2,
            default=(math.inf, 0.0),
            metavar=("AT", "S"),
            help="no message from this time, for so long",
        )
    parser.add_argument(
        "--watchdog",
        type=float,
        default=math.inf,
        metavar="S",
        help="lie down after so long without a command (default: hold the last one, as Unitree's simulator does)",
    )
    parser.add_argument("--seed", type=int, default=0, help="of what is lost")
    parser.add_argument("--record", type=Path, help=".npz of height, tilt and contacts at 50 Hz")
    return parser


if __name__ == "__main__":
    sys.exit(main())
