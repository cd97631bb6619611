"""An exported policy in a bare control loop: MuJoCo, onnxruntime and the policy's own metadata.

    python -m camp.deploy outputs/latest/policy.onnx --skill trot_3hz --command 0.6 0 0

This is what a controller of the real robot does, with MuJoCo in the robot's place: `camp.deployment.loop` is the part
to carry over. Besides, this takes of camp the robot's model file, and for the line it prints the measure of gaits.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from camp.common.arguments import Parser
from camp.common.errors import CampError
from camp.common.mujoco_log import no_log_file
from camp.deployment.loop import Policy, control
from camp.deployment.loop import observe as observe  # for loops like this one
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
