"""An exported policy in a bare control loop: MuJoCo, onnxruntime and the policy's own metadata.

    python -m camp.deploy outputs/latest/policy.onnx --skill trot_3hz --command 0.6 0 0

This is what a controller of the real robot does, with MuJoCo in the robot's place: `observe` and `walk` are the parts
to carry over. Of camp it takes the robot's model file, the reading of the metadata, and for the line it prints the
measure of gaits.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import mujoco
import numpy as np
from numpy.typing import NDArray

from camp.common.errors import CampError
from camp.common.mujoco_log import no_log_file
from camp.deployment.metadata import read_metadata
from camp.metrics.contact import debounced
from camp.metrics.gait import measure_gait
from camp.robots.quadruped import CONTACT_FORCE, FOOT_NAMES
from camp.robots.registry import find_robot

Array = NDArray[np.float32]

FALL_TILT = 0.8  # rad, between the trunk's and the world's vertical
SETTLING_S = 2.0  # left out of what is measured
DIVERGED = (  # MuJoCo starts anew after these, with no more than a warning
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


class Policy:
    """policy.onnx: observation in, joint targets out, and the metadata that tells how to speak to it."""

    def __init__(self, path: Path):
        """Raises CampError where the file or onnxruntime is missing, or the file is no exported policy."""
        try:
            import onnxruntime
        except ImportError as error:
            raise CampError(
                "package onnxruntime: not installed; install camp's extra `export`: "
                "pip install -e '.[export]' -c constraints.txt"
            ) from error
        if not path.is_file():
            raise CampError(f"policy {path}: not found; write it with `python -m camp.export run=<run folder>`")
        try:
            self._session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
        except Exception as error:  # onnxruntime has no class of its own for all that a damaged file raises
            raise CampError(f"policy {path}: not a readable ONNX file; export it again") from error
        properties = self._session.get_modelmeta().custom_metadata_map
        if "joint_names" not in properties:
            raise CampError(f"policy {path}: holds no metadata of camp.export; export it again")
        try:
            self.metadata: dict[str, Any] = read_metadata(properties)
        except CampError as error:
            raise CampError(f"policy {path}: {error}") from error
        shapes = [(one.name, one.shape[-1:]) for one in (*self._session.get_inputs(), *self._session.get_outputs())]
        observed = sum(entry["size"] for entry in self.metadata["observation"])
        expected = [("obs", [observed]), ("joint_target", [len(self.metadata["joint_names"])])]
        if shapes != expected:
            raise CampError(f"policy {path}: maps {shapes}, its metadata say {expected}; export it again")

    def one_hot(self, skill: str) -> Array:
        """The observation's `skill` entry, (K,). Raises CampError for a skill that the policy does not know."""
        known = self.metadata["skills"]
        if skill not in known:
            raise CampError(f"skill {skill!r}: unknown to this policy; choose one of {', '.join(known)}")
        return np.array([name == skill and self.metadata["observe_skill"] for name in known], np.float32)

    def within_range(self, command: Sequence[float]) -> list[float]:
        """vx, vy in m/s, yaw rate in rad/s, clipped to the range of training; as it is where the policy names none."""
        ranges = self.metadata.get("command_range")
        if ranges is None:
            return list(command)
        return [min(max(value, low), high) for value, (low, high) in zip(command, ranges.values(), strict=True)]

    def joint_target(self, observation: Array) -> Array:
        """(45 + K,) -> (12,) rad. Raises CampError for an answer that is no number."""
        (answer,) = self._session.run(None, {"obs": observation[None]})
        target = np.asarray(answer, dtype=np.float32)[0]
        if not np.isfinite(target).all():
            joint = self.metadata["joint_names"][int(np.argmin(np.isfinite(target)))]
            raise CampError(f"the policy's target for {joint} is not finite: its weights are damaged; export it again")
        return target


class Robot:
    """One simulated robot on flat ground, its joints in the order of the metadata's ``joint_names``."""

    def __init__(self, metadata: dict[str, Any]):
        """Raises CampError for a control period that the physics timestep does not divide."""
        no_log_file()
        self.model = mujoco.MjModel.from_xml_path(str(find_robot(metadata["robot"]).model_path))
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in metadata["joint_names"]]
        self._position = np.array([joint.qposadr[0] for joint in joints])
        self._velocity = np.array([joint.dofadr[0] for joint in joints])
        self._actuator = np.array([self.model.actuator(name).id for name in metadata["joint_names"]])
        period, timestep = metadata["control_period"], self.model.opt.timestep
        self._substeps = round(period / timestep)
        if not math.isclose(self._substeps * timestep, period):
            raise CampError(
                f"metadata control_period = {period:g}: no multiple of the physics timestep, {timestep:g} s; export a "
                "policy that was trained at one"
            )
        # A position actuator's force is kp (target - q) - kd q', clipped at the torque limit in the model.
        self.model.actuator_gainprm[self._actuator, 0] = metadata["kp"]
        self.model.actuator_biasprm[self._actuator, 1] = -np.array(metadata["kp"])
        self.model.actuator_biasprm[self._actuator, 2] = -np.array(metadata["kd"])
        self._stand(np.array(metadata["default_pose"]))

    def _stand(self, pose: NDArray[np.float64]) -> None:
        """Put the robot on the ground in a pose (12,), rad, its lowest foot just touching."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._position] = pose
        self.data.ctrl[self._actuator] = pose
        mujoco.mj_kinematics(self.model, self.data)
        feet = [self.model.geom(f"{leg}_foot").id for leg in FOOT_NAMES]
        self.data.qpos[2] -= (self.data.geom_xpos[feet, 2] - self.model.geom_size[feet, 0]).min()
        mujoco.mj_forward(self.model, self.data)

    def hold(self, target: Array) -> None:
        """Hold joint targets (12,) in rad for one control period. Raises CampError where the simulation diverges."""
        self.data.ctrl[self._actuator] = target
        mujoco.mj_step(self.model, self.data, self._substeps)
        if any(self.data.warning[kind].number for kind in DIVERGED):
            raise CampError("the robot's state is not finite: the simulation diverged; check the metadata's kp and kd")

    @property
    def joint_position(self) -> Array:
        """(12,) rad."""
        return self.data.qpos[self._position].astype(np.float32)

    @property
    def joint_velocity(self) -> Array:
        """(12,) rad/s."""
        return self.data.qvel[self._velocity].astype(np.float32)

    @property
    def angular_velocity(self) -> Array:
        """(3,) rad/s, base frame: the gyroscope."""
        return self.data.qvel[3:6].astype(np.float32)

    @property
    def gravity(self) -> Array:
        """(3,) unit vector of gravity, base frame: from the attitude that an inertial unit estimates."""
        w, x, y, z = self.data.qpos[3:7].astype(np.float32)
        return np.array([2 * (w * y - x * z), -2 * (w * x + y * z), 2 * (x * x + y * y) - 1], np.float32)

    @property
    def velocity(self) -> Array:
        """(3,) vx, vy in m/s and yaw rate in rad/s, base frame. Measured, not observed."""
        linear, inverse = np.zeros(3), np.zeros(4)
        mujoco.mju_negQuat(inverse, self.data.qpos[3:7])
        mujoco.mju_rotVecQuat(linear, self.data.qvel[:3], inverse)
        return np.array([*linear[:2], self.data.qvel[5]], np.float32)

    def touches(self, part: str) -> bool:
        """Whether a foot ("FL"), the base ("base") or a thigh ("FL_thigh") presses on the ground."""
        return bool(np.linalg.norm(self.data.sensor(f"{part}_contact").data) > CONTACT_FORCE)

    @property
    def fallen(self) -> bool:
        """The base or a thigh on the ground, or the trunk tilted too far."""
        parts = ("base", *(f"{leg}_thigh" for leg in FOOT_NAMES))
        return any(map(self.touches, parts)) or bool(np.arccos(np.clip(-self.gravity[2], -1, 1)) > FALL_TILT)


@dataclass
class Walk:
    """What a robot did over T control steps, fewer where it fell."""

    qpos: NDArray[np.float64]  # (T, 19) at the end of each step: base position, base quaternion (w first), joints
    joint_target: Array  # (T, 12) rad, held during it
    velocity: Array  # (T, 3) vx, vy in m/s, yaw rate in rad/s, base frame
    contact: NDArray[np.bool_]  # (T, 4) FL, FR, RL, RR
    fell: bool


def observe(policy: Policy, robot: Robot, command: Array, skill: Array, last_action: Array) -> Array:
    """The policy's observation, (45 + K,): raw readings in SI units, in the order that the metadata names."""
    entries = {
        "base_angular_velocity": robot.angular_velocity,
        "gravity": robot.gravity,
        "command": command,
        "joint_position": robot.joint_position - np.array(policy.metadata["default_pose"], np.float32),
        "joint_velocity": robot.joint_velocity,
        "last_action": last_action,
        "skill": skill,
    }
    return np.concatenate([entries[entry["name"]] for entry in policy.metadata["observation"]], dtype=np.float32)


def walk(policy: Policy, skill: str, command: Sequence[float], seconds: float) -> Walk:
    """Walk from standing until the time is over or the robot falls.

    command: vx, vy in m/s, yaw rate in rad/s. Raises CampError for a skill that the policy does not know, and for an
    answer or a state that is not finite.
    """
    metadata, robot = policy.metadata, Robot(policy.metadata)
    pose, scale = np.array(metadata["default_pose"], np.float32), np.float32(metadata["action_scale"])
    one_hot, wanted = policy.one_hot(skill), np.array(command, np.float32)
    last_action = np.zeros_like(pose)
    rows = []
    for _ in range(round(seconds / metadata["control_period"])):
        target = policy.joint_target(observe(policy, robot, wanted, one_hot, last_action))
        robot.hold(target)
        last_action = (target - pose) / scale
        rows.append((robot.data.qpos.copy(), target, robot.velocity, [robot.touches(foot) for foot in FOOT_NAMES]))
        if robot.fallen:
            break
    return Walk(*map(np.array, zip(*rows, strict=True)), fell=robot.fallen)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """One line for `main` to print, instead of four."""
        raise CampError(f"{message}; see --help")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0, or 2 for input that cannot be used."""
    parser = _Parser(prog="python -m camp.deploy", description="Run an exported policy in MuJoCo.")
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
