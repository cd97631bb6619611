"""An exported policy in a bare control loop: MuJoCo, onnxruntime and the policy's own metadata.

    python -m camp.deploy outputs/latest/policy.onnx --skill trot_3hz --command 0.6 0 0

This is what a controller of the real robot does, with MuJoCo in the robot's place: `camp.deployment.loop` is the part
to carry over, `camp.deployment.simulated` is MuJoCo. For the line that this prints it takes camp's measure of gaits.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from camp.common.arguments import Parser
from camp.common.errors import CampError
from camp.deployment.loop import Array, Policy, control
from camp.deployment.loop import observe as observe  # for loops like this one
from camp.deployment.simulated import FALL_TILT as FALL_TILT
from camp.deployment.simulated import Robot
from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait
from camp.robots.quadruped import FOOT_NAMES

SETTLING_S = 2.0  # left out of what is measured


@dataclass
class Walk:
    """What a robot did over T control steps, fewer where it fell."""

    qpos: NDArray[np.float64]  # (T, 19) at the end of each step: base position, base quaternion (w first), joints
    joint_target: Array  # (T, 12) rad, held during it
    velocity: Array  # (T, 3) vx, vy in m/s, yaw rate in rad/s, base frame
    contact: NDArray[np.bool_]  # (T, 4) FL, FR, RL, RR
    fell: bool


def walk(policy: Policy, skill: str, command: Sequence[float], seconds: float) -> Walk:
    """Walk from standing until the time is over or the robot falls.

    command: vx, vy in m/s, yaw rate in rad/s. Raises CampError for a skill that the policy does not know, and for an
    answer or a state that is not finite.
    """
    robot, steps = Robot(policy.metadata), round(seconds / policy.metadata["control_period"])
    rows = []
    for target in islice(control(policy, robot, skill, command), steps):
        rows.append((robot.data.qpos.copy(), target, robot.velocity, [robot.touches(foot) for foot in FOOT_NAMES]))
        if robot.fallen:
            break
    return Walk(*map(np.array, zip(*rows, strict=True)), fell=robot.fallen)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, or 2 for input that cannot be used."""
    parser = Parser(prog="python -m camp.deploy", description="Run an exported policy in MuJoCo.")
    parser.add_argument("policy", type=Path, help="policy.onnx, which camp.export writes")
    parser.add_argument("--skill", required=True, help="one of the policy's skills (policy.json lists them)")
    parser.add_argument(
        "--command",
        type=float,
        nargs=3,
        metavar=("VX", "VY", "WZ"),
        default=(0.6, 0.0, 0.0),
        help="m/s forward, m/s to the left, rad/s to the left (default: 0.6 0 0)",
    )
    parser.add_argument("--seconds", type=float, default=10.0, help="duration in s, at least 4 (default: %(default)s)")
    try:
        options = parser.parse_args(arguments)
        if not 2 * SETTLING_S <= options.seconds < math.inf:
            raise CampError(f"--seconds {options.seconds:g}: choose {2 * SETTLING_S:g} or more, to see strides")
        if not np.isfinite(options.command).all():
            raise CampError(f"--command {' '.join(map(str, options.command))}: give three finite numbers")
        policy = Policy(options.policy)
        command = policy.within_range(options.command)
        if command != list(options.command):
            given, used = (" ".join(f"{number:g}" for number in numbers) for numbers in (options.command, command))
            print(f"command:   {given} is beyond what the policy was trained for; {used} is asked for", flush=True)
        done = walk(policy, options.skill, command, options.seconds)
    except CampError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    period = policy.metadata["control_period"]
    asked = "{:.2f} {:.2f} m/s {:.2f} rad/s".format(*command)
    print(f"asked:     {options.skill} at {asked}")
    if done.fell:
        print(f"performed: fell after {len(done.qpos) * period:.2f} s")
        return 0
    settled = slice(round(SETTLING_S / period), None)
    contact, velocity = debounced(done.contact[None, settled], period), done.velocity[settled].mean(axis=0)
    gait = measure_gait(contact, period)
    reached = "{:.2f} {:.2f} m/s {:.2f} rad/s".format(*velocity)
    strides = f"{gait.frequency_hz[0]:.2f} strides per s" if gait.stepping.any() else "no strides"
    print(f"performed: {gait.label[0]} at {reached}, {strides}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
