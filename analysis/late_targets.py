"""Walks whose targets reach the motors late: `python -m analysis.late_targets policy=<policy.onnx> [late_s=0.02]`.

Every skill walks from standing at 0.6 and 0.3 m/s for 6 s in the loop of `camp.deploy`, and each target reaches the
motors so much later. A walk is right where the robot stays upright and shows the commanded skill, by gait and stride
frequency of the last 4 s. `camp.evaluate 'parts=[gait,robustness]'` applies all of suite v1's criteria.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camp.cli.key_values import key_values, run_command
from camp.common.errors import ConfigError
from camp.deployment.loop import Array, Memory, Policy
from camp.deployment.simulated import Robot
from camp.evaluation.contract import parse_skill
from camp.gaits.skills import performed
from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait
from camp.robots.quadruped import FOOT_NAMES
from camp.sim.delay import LONGEST_DELAY

SPEEDS_M_S = (0.6, 0.3)
WALK_S, DISCARDED_S = 6.0, 2.0


def walks_late(policy: Policy, skill: str, speed: float, late_s: float) -> bool:
    """Whether one walk is right. late_s: s, rounded to physics steps."""
    robot, memory = Robot(policy.metadata), Memory(policy)
    period, timestep = policy.metadata["control_period"], float(robot.model.opt.timestep)
    substeps, late = round(period / timestep), round(late_s / timestep)
    pose = np.array(policy.metadata["default_pose"], np.float32)
    on_its_way: deque[Array] = deque([pose] * late)  # one target for each physics step until it arrives
    contact = []
    for _ in range(round(WALK_S / period)):
        on_its_way.extend([memory.target(robot, skill, (speed, 0.0, 0.0))] * substeps)
        for _ in range(substeps):
            robot.aim(on_its_way.popleft())
            robot.step()
        if robot.fallen:
            return False
        contact.append([robot.touches(foot) for foot in FOOT_NAMES])
    settled = debounced(np.array(contact), period)[None, round(DISCARDED_S / period) :]
    gait = measure_gait(settled, period)
    known = [parse_skill(name) for name in policy.metadata["skills"]]
    return performed(gait.label, gait.frequency_hz, known)[0] == skill


def late_targets(arguments: Sequence[str]) -> None:
    """Carry out the command line."""
    given = key_values(arguments, required=["policy"], optional=["late_s"])
    try:
        late_s = float(given.get("late_s", "0.02"))
    except ValueError as error:
        raise ConfigError(f"late_s = {given['late_s']!r}: give seconds, such as 0.02") from error
    if not 0.0 <= late_s <= LONGEST_DELAY:
        raise ConfigError(f"late_s = {late_s:g}: give 0 to {LONGEST_DELAY:g} s")
    policy = Policy(Path(given["policy"]))
    cells = [(skill, speed) for skill in policy.metadata["skills"] for speed in SPEEDS_M_S]
    wrong = [f"{skill} at {speed:g} m/s" for skill, speed in cells if not walks_late(policy, skill, speed, late_s)]
    print(f"targets {1000 * late_s:g} ms late: {len(cells) - len(wrong)} of {len(cells)} walks are right")
    if wrong:
        print(f"not right: {', '.join(wrong)}")


if __name__ == "__main__":
    sys.exit(run_command(late_targets, sys.argv[1:], __doc__))
