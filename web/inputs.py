"""What the web page takes from the project: `python -m web.inputs run=<run folder or shipped policy> output=<folder>`.

Writes policy.onnx and policy.json as `camp.export` does, the robot's model as robot.xml, and rules.json: the numbers by
which camp tells contacts, gaits and falls, so that the page holds no copy of them.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from camp.build import load_run
from camp.cli.key_values import key_values, run_command
from camp.common.files import write_text
from camp.deploy import FALL_TILT
from camp.deployment.export import export_policy
from camp.gaits.gait import GAITS
from camp.gaits.skills import FREQUENCY_TOLERANCE
from camp.metrics import contact, gait
from camp.robots.quadruped import CONTACT_FORCE, FOOT_NAMES
from camp.robots.registry import find_robot

WINDOW_S = 1.0  # over which the page measures, as `camp.metrics.gait.measure_over_time` does


def rules(push_m_s: float) -> dict[str, Any]:
    """camp's numbers for contacts, gaits and falls, each with its unit in its name."""
    return {
        "feet": list(FOOT_NAMES),
        "contact_force_n": CONTACT_FORCE,
        "bounce_s": contact.BOUNCE_S,
        "fall_tilt_rad": FALL_TILT,
        "push_m_s": push_m_s,
        "window_s": WINDOW_S,
        "segment_s": gait.SEGMENT_S,
        "frequency_range_hz": list(gait.FREQUENCY_RANGE_HZ),
        "frequency_step_hz": gait.FREQUENCY_STEP_HZ,
        "duty_range": list(gait.DUTY_RANGE),
        "rhythm_min": gait.RHYTHM_MIN,
        "phase_tolerance": gait.PHASE_TOLERANCE,
        "frequency_tolerance": FREQUENCY_TOLERANCE,
        "no_gait": gait.NO_GAIT,
        "gaits": [{"name": one.name, "phases": list(one.phases), "colour": one.colour} for one in GAITS.values()],
    }


def write_inputs(run: Path, output: Path) -> None:
    """Write the four files into the folder ``output``. Raises CampError."""
    config = load_run(run).config
    export_policy(run, output)
    model = find_robot(config.robot.name).model_path
    write_text(output / "robot.xml", model.read_text(encoding="utf-8"))
    write_text(output / "rules.json", json.dumps(rules(config.env.push.max_velocity_m_s), indent=2) + "\n")


def main(arguments: Sequence[str]) -> None:
    """Carry out the command line."""
    given = key_values(arguments, required=["run", "output"])
    write_inputs(Path(given["run"]), Path(given["output"]))
    print(f"wrote policy.onnx, policy.json, robot.xml and rules.json into {given['output']}")


if __name__ == "__main__":
    sys.exit(run_command(main, sys.argv[1:], __doc__))
