"""What led to a divergence, simulated again: ``python -m camp.replay <dump> [video=<file>]``.

<dump> is a file of a run folder's diverged/. Training writes one where a robot's state or action became physically
impossible: the state before the control step, the action, the physical parameters. Prints the step, one line for each
physics step, on the CPU backend.

video=<file>        also an mp4 of the step, slowed down to a tenth of a second for each physics step
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from camp.cli.key_values import key_values, run_command
from camp.common.errors import CheckpointError, ConfigError
from camp.envs.actions import usable
from camp.envs.measurement import measure
from camp.robots.quadruped import JOINT_NAMES, NUM_LEGS
from camp.robots.registry import find_robot
from camp.robots.robot import Robot
from camp.sim.base import Dynamics, InitialState, RobotState
from camp.sim.cpu import CpuSimulator
from camp.sim.delay import LONGEST_DELAY, DelayLine
from camp.sim.divergence import impossible
from camp.sim.motors import MotorLaw
from camp.sim.rendering import RobotRenderer, write_video
from camp.training.dumps import Dump, load_dump

SHOWN = 4  # impossible numbers of one state
FRAMES, FRAMES_PER_S = 3, 30.0  # of a physics step in the video
FURTHEST = 100.0  # m or rad of a pose that is drawn
AGREEMENT = 1e-4  # rad, m, rad/s or m/s, between what training saw and what is simulated here


@dataclass(frozen=True)
class Replay:
    """A control step of S physics steps."""

    robot: Robot
    dynamics: Dynamics
    states: list[RobotState]  # S + 1: before, and after each physics step
    targets: list[Tensor]  # S of (1, 12) rad, that the motors hold during each
    timestep: float  # s


def replay(arguments: Sequence[str]) -> None:
    """Carry out the command line. Raises CampError for a file that cannot be used."""
    places = [argument for argument in arguments if "=" not in argument]
    given = key_values([argument for argument in arguments if "=" in argument], required=[], optional=["video"])
    if len(places) != 1:
        raise ConfigError("give one file, such as outputs/latest/diverged/iteration_00000001_rank0.npz; see --help")
    dump = load_dump(Path(places[0]))
    done = simulate(dump)
    for line in report(dump, done):
        print(line)
    if "video" in given:
        _film(done, Path(given["video"]))
        print(f"wrote {given['video']}")


def simulate(dump: Dump) -> Replay:
    """The step again, on the CPU backend. Raises CampError for another robot, or a state that does not fit it."""
    about = dump.about
    robot = replace(find_robot(about.robot), pd_gain_p=tuple(about.kp) * NUM_LEGS, pd_gain_d=tuple(about.kd) * NUM_LEGS)
    timestep = about.physics_timestep_s
    sim = CpuSimulator(robot, 1, timestep, timestep, threads=1)
    dynamics, before = _dynamics(dump, sim.device), _batch(dump.part("before"))
    sim.prepare(replace(dynamics, delay=torch.zeros(1)))  # the late targets are sent by hand
    sim.reset(torch.ones(1, dtype=torch.bool), InitialState.from_model(before["qpos"].float(), before["qvel"].float()))
    own = {name: value for name, value in sim.state_dict().items() if isinstance(value, Tensor)}
    sim.load_state_dict(own | _fitting(before, own))
    targets = _targets(dump, before)
    states = [sim.state]
    for target in targets:
        sim.step(target)
        states.append(sim.state)
    return Replay(robot, dynamics, states, targets, timestep)


def report(dump: Dump, done: Replay) -> list[str]:
    """Lines of at most 80 columns, but for numbers that are larger than any robot's."""
    about, arrays = dump.about, dump.arrays
    command = "{:.2f} {:.2f} m/s {:.2f} rad/s".format(*arrays["command"])
    lines = [
        f"iteration {about.iteration}, rank {about.rank}, robot {about.env}, step {about.step} of its episode "
        f"({about.backend})",
        f"{about.skill} at {command}; action {_extreme(arrays['action'], '')}",
    ]
    if bool(usable(torch.from_numpy(arrays["action"])[None])[1]):
        lines.append("the action is of no use to a motor, and counts as diverged; the pose was held")
    lines += [_dynamics_line(done.dynamics), "", _HEADER]
    lines += [_row(done, number) for number in range(len(done.states))]
    wrong = [(number, impossible(done.robot, state)) for number, state in enumerate(done.states)]
    first = next(((number, found) for number, found in wrong if found), None)
    if first is not None:
        number, found = first
        more = f", and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
        lines += [
            "",
            f"impossible from {1e3 * number * done.timestep:.1f} ms on{more}:",
            *(f"  {one}" for one in found[:SHOWN]),
        ]
    return [*lines, "", _agreement(dump, done)]


_HEADER = """\
 time   height   tilt   speed    spin  fastest joint           torque   feet
   ms        m    rad     m/s   rad/s               rad/s         N m      N"""


def _row(done: Replay, number: int) -> str:
    state, target = done.states[number], done.targets[max(number - 1, 0)]
    seen = measure(done.robot, state)
    tilt = float(torch.acos((-seen.gravity[0, 2]).clamp(-1.0, 1.0)))
    torque = MotorLaw.of(done.robot, done.dynamics).torque(target, state.joint_position, state.joint_velocity)
    joint, speed = _largest(state.joint_velocity[0])
    numbers = (
        f"{1e3 * number * done.timestep:5.1f}",
        _short(float(state.base_position[0, 2]), 8),
        _short(tilt, 6),
        _short(float(state.base_linear_velocity.norm()), 7),
        _short(float(state.base_angular_velocity.norm()), 7),
        f" {JOINT_NAMES[joint].removesuffix('_joint'):<9}{_short(speed, 9)}",
        _short(float(torque.abs().amax()), 8),
        _short(float(state.foot_force.norm(dim=-1).sum()), 6),
    )
    return " ".join(numbers)


def _agreement(dump: Dump, done: Replay) -> str:
    """Whether training saw the same as what is simulated here."""
    last, reached = done.states[-1], dump.part("reached")
    pairs = ((last.qpos()[0].numpy(), reached["qpos"]), (last.qvel()[0].numpy(), reached["qvel"]))
    if all(np.allclose(here, there, atol=AGREEMENT, rtol=AGREEMENT, equal_nan=True) for here, there in pairs):
        return "training saw the same"
    with np.errstate(invalid="ignore"):
        difference = max(float(np.nan_to_num(np.abs(here - there), nan=np.inf).max()) for here, there in pairs)
    return f"training saw another end (differs by up to {difference:.2g}): another backend, MuJoCo or processor"


def _dynamics_line(dynamics: Dynamics) -> str:
    scales = (dynamics.motor_strength, dynamics.kp_scale, dynamics.kd_scale)
    spread = ", ".join(
        f"{name} {float(value.min()):.2f}-{float(value.max()):.2f}"
        for name, value in zip(("strength", "kp", "kd"), scales, strict=True)
    )
    return f"payload {float(dynamics.payload_mass):.2f} kg, friction {float(dynamics.friction):.2f}, {spread}"


def _extreme(values: np.ndarray, unit: str) -> str:
    joint, _ = _largest(torch.from_numpy(values))
    return f"largest {values[joint]:.4g}{unit} ({JOINT_NAMES[joint]})"


def _largest(values: Tensor) -> tuple[int, float]:
    """The joint with the largest magnitude, one that is no number before all others, and its value."""
    joint = int(values.abs().nan_to_num(torch.inf).argmax())
    return joint, float(values[joint])


def _short(value: float, width: int) -> str:
    plain = f"{value:.2f}"
    return f"{plain if len(plain) <= width else f'{value:.0e}':>{width}}"


def _dynamics(dump: Dump, device: torch.device) -> Dynamics:
    """The robot's physical parameters; those that a dump of an earlier camp lacks are nominal."""
    nominal = Dynamics.nominal(1, 0.8, device)
    return replace(nominal, **_fitting(_batch(dump.part("dynamics")), nominal.tensors()))


def _targets(dump: Dump, before: dict[str, Tensor]) -> list[Tensor]:
    """What the motors hold in each physics step, (1, 12) rad: the step's target, where it is late one before."""
    period, timestep = dump.about.control_period_s, dump.about.physics_timestep_s
    line = DelayLine(1, period, timestep, torch.device("cpu"))
    found = {name.removeprefix("delays."): value for name, value in before.items() if name.startswith("delays.")}
    if "sent" in found:
        found["sent"] = found["sent"].transpose(0, 1)
    if "late" in found:  # no more than a line can hold, whatever a damaged file says
        found["late"] = found["late"].clamp(0, round(LONGEST_DELAY / timestep))
    own = line.state_dict()
    line.load_state_dict(own | _fitting(found, own))
    line.send(torch.from_numpy(dump.arrays["joint_target"]).float()[None])
    return [line.arrived(step) for step in range(round(period / timestep))]


def _fitting(found: dict[str, Tensor], own: dict[str, Tensor]) -> dict[str, Tensor]:
    """Of what was found the part that an own state has, in its types. Raises CheckpointError for other shapes."""
    fitting = {name: found[name].to(value.dtype) for name, value in own.items() if name in found}
    wrong = [name for name, value in fitting.items() if value.shape != own[name].shape]
    if wrong:
        raise CheckpointError(f"dump: {wrong[0]} does not fit this camp; use the camp of the run")
    return fitting


def _batch(arrays: dict[str, np.ndarray]) -> dict[str, Tensor]:
    return {name: torch.from_numpy(array)[None] for name, array in arrays.items()}


def _film(done: Replay, path: Path) -> None:
    """Write the step as an mp4, without the states that cannot be drawn. Raises CampError without OpenGL."""
    renderer = RobotRenderer(done.robot.load_model())
    every = [state.qpos()[0].numpy() for state in done.states]
    poses = [pose for pose in every if np.isfinite(pose).all() and np.abs(pose).max() < FURTHEST]
    try:
        if not poses:
            raise ConfigError(f"video {path}: no state of the step can be drawn; leave video= out")
        write_video(path, (renderer.frame(pose) for pose in poses for _ in range(FRAMES)), FRAMES_PER_S)
    except RuntimeError as error:  # imageio reports a missing ffmpeg so
        raise ConfigError(f"video {path}: {' '.join(str(error).split())}; leave video= out") from error
    finally:
        renderer.close()


if __name__ == "__main__":
    sys.exit(run_command(replay, sys.argv[1:], __doc__))
