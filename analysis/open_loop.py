"""A hand-written open-loop gait generator as ONNX and contract: `python -m analysis.open_loop <folder>`.

Nobody trained it: legs lift and sweep on a clock. It shows how to write a contract for `python -m camp.judge` from
nothing, and what walking without feedback is worth by it. Writes open_loop.onnx and open_loop.json.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from analysis.load import AnalysisError
from camp.cli.key_values import run_command
from camp.common.files import make_folder, whole_file, write_text
from camp.evaluation.contract import CommandRange, Contract, Output, Term
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import Skill, skill_set
from camp.robots.go2 import GO2
from camp.robots.quadruped import JOINT_NAMES, NUM_LEGS

SKILLS = skill_set(tuple(GAIT_PHASES), "gait_frequency", (2.0, 3.0))
LIFT_RAD = 0.4  # of the thigh at the top of the swing; the calf bends twice as far
SWEEP_RAD = 0.45  # of the thigh, forward and back, per m/s and s of a stride
WIDTH = 2 * NUM_LEGS + 1  # of a skill's encoding: cosine and sine of each leg's phase, stride duration


def contract() -> Contract:
    """How to speak to the graph."""
    return Contract(
        contract=1,
        name="open_loop",
        robot=GO2.name,
        control_period_s=0.02,
        joint_names=list(JOINT_NAMES),
        default_pose=list(GO2.default_joint_position),
        kp=list(GO2.pd_gain_p),
        kd=list(GO2.pd_gain_d),
        output=Output(scale=1.0, offset=list(GO2.default_joint_position)),
        observation=[Term("phase"), Term("command"), Term("skill")],
        skills={skill.name: _encoding(skill) for skill in SKILLS},
        command_range=CommandRange((-0.4, 0.9), (-0.25, 0.25), (-0.6, 0.6)),
    )


def _encoding(skill: Skill) -> list[float]:
    angle = 2 * math.pi * np.array(GAIT_PHASES[skill.gait])
    assert skill.frequency_hz is not None
    return [*np.cos(angle).round(6), *np.sin(angle).round(6), 1.0 / skill.frequency_hz]


def graph() -> onnx.ModelProto:
    """obs (N, 14) = sine and cosine of the clock, command, encoding -> joint offsets (N, 12) in rad.

    Each leg's phase runs a from its touchdown: it stands while sin a > 0, swings while sin a < 0, and is furthest
    ahead at a = 0.
    """
    nodes: list[onnx.NodeProto] = []
    constants: list[onnx.TensorProto] = []

    def constant(name: str, value: np.ndarray) -> str:
        constants.append(numpy_helper.from_array(np.asarray(value, dtype=np.float32), name))
        return name

    def add(operator: str, output: str, *inputs: str) -> str:
        nodes.append(helper.make_node(operator, list(inputs), [output]))
        return output

    parts = {"sin": 1, "cos": 1, "vx": 1, "vy": 1, "wz": 1, "leg_cos": 4, "leg_sin": 4, "stride": 1}
    constants.append(numpy_helper.from_array(np.array(list(parts.values()), dtype=np.int64), "sizes"))
    nodes.append(helper.make_node("Split", ["obs", "sizes"], list(parts), axis=1))
    # sin(a) and cos(a) of each leg, by the addition theorems.
    sine = add("Sub", "sine", add("Mul", "a", "sin", "leg_cos"), add("Mul", "b", "cos", "leg_sin"))
    cosine = add("Add", "cosine", add("Mul", "c", "cos", "leg_cos"), add("Mul", "d", "sin", "leg_sin"))
    swing = add("Relu", "swing", add("Neg", "minus_sine", sine))
    bend = add("Mul", "bend", swing, constant("lift_rad", np.array(LIFT_RAD)))  # (N, 4); the calf bends twice as far
    # A leg ahead has a smaller thigh angle. Turning: the right legs go further than the left ones.
    turn = add("Mul", "turn", "wz", constant("side", np.array([[-0.15, 0.15, -0.15, 0.15]])))
    speed = add("Add", "speed", "vx", turn)
    reach = add("Mul", "reach", add("Mul", "per_stride", speed, "stride"), constant("sweep", np.array(-SWEEP_RAD * 2)))
    thigh = add("Add", "thigh", bend, add("Mul", "swept", reach, cosine))
    calf = add("Mul", "calf", bend, constant("twice", np.array(-2.0)))
    sideways = add("Mul", "sideways", add("Mul", "drift", "vy", "stride"), constant("hip_gain", np.array(0.8)))
    hip = add("Mul", "hip", sideways, cosine)
    # Joints leg by leg: hip, thigh, calf.
    three = [add("Unsqueeze", f"{name}_3", name, _axis(constants, name)) for name in (hip, thigh, calf)]
    nodes.append(helper.make_node("Concat", three, ["stacked"], axis=2))
    constants.append(numpy_helper.from_array(np.array([-1, 12], dtype=np.int64), "shape"))
    add("Reshape", "offset", "stacked", "shape")
    model = helper.make_model(
        helper.make_graph(
            nodes,
            "open_loop",
            [helper.make_tensor_value_info("obs", TensorProto.FLOAT, ["N", 5 + WIDTH])],
            [helper.make_tensor_value_info("offset", TensorProto.FLOAT, ["N", 12])],
            constants,
        ),
        opset_imports=[helper.make_opsetid("", 17)],
        ir_version=8,
    )
    onnx.checker.check_model(model, full_check=True)
    return model


def _axis(constants: list[onnx.TensorProto], name: str) -> str:
    constants.append(numpy_helper.from_array(np.array([2], dtype=np.int64), f"{name}_axis"))
    return f"{name}_axis"


def write(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises AnalysisError without exactly one folder."""
    if len(arguments) != 1:
        raise AnalysisError("give one folder to write to: python -m analysis.open_loop <folder>")
    folder = make_folder(Path(arguments[0]))
    with whole_file(folder / "open_loop.onnx") as file:
        file.write(graph().SerializeToString())
    write_text(folder / "open_loop.json", json.dumps(asdict(contract()), indent=2) + "\n")
    print(f"wrote {folder / 'open_loop.onnx'} and {folder / 'open_loop.json'}")


if __name__ == "__main__":
    sys.exit(run_command(write, sys.argv[1:], __doc__))
