"""An exported policy on a Unitree Go2, real or simulated, over its low-level interface (docs/go2.md).

    python -m camp.go2 outputs/go2_camp/policy.onnx --interface eth0

Never run on hardware. Read docs/go2.md first.
"""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from camp.common.arguments import Parser
from camp.common.errors import CampError
from camp.deployment.loop import Policy
from camp.lowlevel import remote
from camp.lowlevel.controller import Controller, Desk
from camp.lowlevel.keyboard import keyboard
from camp.lowlevel.message_log import MessageLog
from camp.lowlevel.operator import Input, Wanted
from camp.lowlevel.pace import Lockstep, RealTime
from camp.lowlevel.packages import require_dds
from camp.lowlevel.script import EXAMPLE, Script, read_script
from camp.lowlevel.start import take_over
from camp.lowlevel.walker import Walker

ROBOT = "go2"
LOOPBACK = "lo"
REAL_DOMAIN, SIMULATED_DOMAIN = 0, 1  # the robot's, and the one of Unitree's simulator


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, 1 for a fault, 2 for input that cannot be used."""
    try:
        return run(_parser().parse_args(arguments))
    except CampError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def run(options: argparse.Namespace) -> int:
    """Take the robot over and control it. Raises CampError before the first command."""
    policy = Policy(options.policy)
    if policy.metadata["robot"] != ROBOT:
        raise CampError(f"policy {options.policy}: trained for {policy.metadata['robot']!r}, not for {ROBOT!r}")
    wanted = Wanted.of(policy.metadata, options.skill)
    policy.one_hot(wanted.skill)
    entries = None if options.script is None else read_script(options.script, wanted.skills)
    require_dds()
    from camp.lowlevel.dds import DdsRobotLink, Network
    from camp.lowlevel.motion_switcher import MotionSwitcher

    walker = Walker(policy)
    with ExitStack() as stack:
        network = Network(options.interface, domain_of(options))
        log = MessageLog(options.log)
        stack.callback(log.close)
        asks = Script(entries) if entries is not None else _input(options.input, stack)
        link = DdsRobotLink(network)
        take_over(link, None if options.no_sport_mode else MotionSwitcher(network))
        print("the robot answers and nobody else commands it: passive", flush=True)
        pace = (Lockstep if options.lockstep else RealTime)(walker.period_s)
        controller = Controller(link, walker, pace, Desk(asks, wanted, log))
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            stack.callback(signal.signal, number, signal.getsignal(number))
            signal.signal(number, lambda *_: controller.interrupt())
        fault = controller.run()
    print(log.summary())
    if options.log is not None:
        print(f"wrote {options.log}")
    if fault is not None:
        print(f"stopped: {fault}", file=sys.stderr)
    return int(fault is not None)


def domain_of(options: argparse.Namespace) -> int:
    """The DDS domain: the one that is given, or the interface's usual one."""
    if options.domain is not None:
        return int(options.domain)
    return SIMULATED_DOMAIN if options.interface == LOOPBACK else REAL_DOMAIN


def _input(name: str, stack: ExitStack) -> Input:
    if name == "keyboard":
        return stack.enter_context(keyboard())
    print(remote.HELP)
    return remote.RemoteInput()


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="python -m camp.go2", description="Run an exported policy on a Unitree Go2.")
    parser.add_argument(
        "policy",
        type=Path,
        nargs="?",
        default=Path("outputs/go2_camp/policy.onnx"),
        help="policy.onnx, which camp.export writes (default: %(default)s, the shipped policy's)",
    )
    parser.add_argument("--interface", required=True, help="network interface to the robot; lo: a simulated one")
    parser.add_argument("--domain", type=int, help="DDS domain (default: 0, the robot's; on lo 1)")
    parser.add_argument("--input", choices=("keyboard", "remote"), default="keyboard", help="default: %(default)s")
    parser.add_argument("--script", help=f"orders by time instead, such as {EXAMPLE!r}")
    parser.add_argument("--skill", help="skill to begin with (default: the policy's first)")
    parser.add_argument(
        "--log",
        type=Path,
        default=Path(f"outputs/go2/{time.strftime('%Y-%m-%d_%H-%M-%S')}.csv"),
        help="file for rate, age and jitter of the messages (default: %(default)s)",
    )
    parser.add_argument("--no-sport-mode", action="store_true", help="there is none to release: Unitree's simulator")
    parser.add_argument("--lockstep", action="store_true", help="wait for camp.go2_sim --lockstep, step by step")
    return parser


if __name__ == "__main__":
    sys.exit(main())
