"""Parameters of the expert in SI units, found by trial on the Go2; what differs by gait stands in one place.

Lengths and force limits follow the robot; weights and gains do not, since the MPC and the whole-body controller
measure masses and inertias from the model.

Weights are diagonals of quadratic costs on the SRB state: roll-pitch-yaw, position, angular and linear
velocity.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from camp.robots.robot import Robot

PACE_WIDTH = 0.634  # of the usual distance between left and right feet
BOUND_LENGTH = 0.879  # of the usual distance between front and rear feet
FORCE_MARGIN = 1.2  # times the planned forces' limit, for feedback


def _diagonal(rpy: tuple, position: tuple, angular: tuple, linear: tuple) -> np.ndarray:
    return np.array([*rpy, *position, *angular, *linear], dtype=float)


@dataclass(frozen=True)
class Posture:
    """Where the CoM and the feet are in the middle of stance."""

    com_height: float  # m above the floor
    foot_x: float  # m ahead of or behind the CoM
    foot_y: float  # m beside the CoM
    swing_height: float = 0.07  # m clearance in mid-swing


@dataclass(frozen=True)
class ReferenceWeights:
    """Cost and bounds of the periodic reference motion."""

    largest_force: float  # N per foot
    state: np.ndarray = field(
        default_factory=lambda: _diagonal((60, 20, 20), (20, 20, 60), (0.3, 0.15, 0.3), (2, 2, 0.2))
    )
    force: float = 1e-5  # per N^2 s
    force_change: float = 4e-7  # per N^2/s, makes forces rise and fall smoothly
    friction: float = 0.45  # below the MPC's, so that feedback has room left
    smallest_force: float = 2.0  # N, keeps a standing foot on the floor


@dataclass(frozen=True)
class MpcWeights:
    """Cost and bounds of the model predictive controller."""

    largest_force: float  # N per foot
    state: np.ndarray = field(
        default_factory=lambda: _diagonal((120, 120, 60), (40, 40, 150), (1.5, 1.5, 1.5), (8, 8, 4))
    )
    force: float = 1e-5  # on the difference to the reference force, per N^2
    friction: float = 0.5  # the floor's is .8
    smallest_force: float = 2.0  # N, keeps a standing foot on the floor


@dataclass(frozen=True)
class SwingGains:
    """Foot placement and tracking of the swing trajectory."""

    velocity_gain: float = 0.16  # s, capture-point feedback from CoM velocity error to foothold
    stiffness: float = 900.0  # 1/s^2
    damping: float = 55.0  # 1/s
    commit_phase: float = 0.85  # swing phase after which the foothold stays fixed
    arrival_phase: float = 0.95  # swing phase at which the foot is above its foothold


@dataclass(frozen=True)
class WholeBodyGains:
    """Feedback gains and task weights of the whole-body controller."""

    largest_force: float  # N per foot
    linear_stiffness: float = 20.0  # 1/s^2
    linear_damping: float = 4.0  # 1/s
    angular_stiffness: float = 120.0  # 1/s^2
    angular_damping: float = 15.0  # 1/s
    stance_damping: float = 30.0  # 1/s, stops a sliding foot
    late_speed: float = 0.25  # m/s downwards for a foot that should stand but hangs
    linear_weight: float = 1.0
    angular_weight: float = 0.3
    flight_angular_weight: float = 6e-4  # in flight the trunk may only turn by moving the legs: let it
    foot_weight: float = 0.015
    force_weight: float = 2e-4
    late_force_weight: float = 2e-2  # holds the force of a hanging foot at zero
    acceleration_weight: float = 2e-5
    friction: float = 0.55
    torque_fraction: float = 0.98  # of the limit


@dataclass(frozen=True)
class ExpertParameters:
    """Everything the expert needs for one gait at one frequency."""

    posture: Posture
    reference: ReferenceWeights
    mpc: MpcWeights
    swing: SwingGains
    whole_body: WholeBodyGains


def expert_parameters(robot: Robot, gait: str, frequency_hz: float, height: float = 0.0) -> ExpertParameters:
    """Parameters for a gait at a stride frequency in Hz; `height` in m is added to the CoM's usual one."""
    leg, force, swing = robot.leg, robot.largest_foot_force, SwingGains()
    width = _rounded(leg.hip_y + leg.hip_offset)  # feet below the thigh joints
    posture = Posture(robot.walking_com_height + height, foot_x=leg.hip_x, foot_y=width)
    reference, mpc = ReferenceWeights(force), MpcWeights(force)
    if frequency_hz > 3.5:
        posture = replace(posture, swing_height=0.05)  # .07 m in .125 s asks for 38 N m at the knee
    if gait == "pace":
        posture = replace(posture, foot_y=_rounded(PACE_WIDTH * width))  # legs closer together roll the trunk less
    if gait == "bound":
        # A bound pitches: holding the trunk level costs fore-aft forces that break the gait at 2 Hz.
        posture = replace(posture, foot_x=_rounded(BOUND_LENGTH * leg.hip_x))
        reference = ReferenceWeights(force, _diagonal((60, 0.2, 20), (20, 20, 60), (0.3, 0.15, 0.3), (10, 2, 0.2)))
        mpc = MpcWeights(force, _diagonal((120, 15, 60), (40, 40, 150), (1.5, 1.5, 1.5), (8, 8, 4)))
    if gait == "bound" and frequency_hz > 3.5:
        # Feet that leave late and touch down early would leave no flight of the 21 ms that are planned.
        posture = replace(posture, swing_height=0.07)
    if (gait, frequency_hz) in (("bound", 4.0), ("pronk", 2.0)):
        swing = replace(swing, arrival_phase=1.0)  # by trial: keeps more contacts on the schedule
    return ExpertParameters(posture, reference, mpc, swing, WholeBodyGains(FORCE_MARGIN * force))


def _rounded(length: float) -> float:
    """A length in m to a tenth of a millimetre."""
    return round(length, 4)
