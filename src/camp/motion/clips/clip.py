"""One expert motion.

Legs are FL, FR, RL, RR and joints hip, thigh, calf of each leg; quaternions have w first; T control steps.
Row t holds the state in which `joint_target[t]` was given.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camp.robots.amp_state import amp_parts
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES

EXPERT = "expert"  # the source of a clip whose targets and torques are known
STAND = "stand"  # the gait of a clip in which all feet stay down; its frequency is 0

# What a clip shows: one command held; changing commands, speed ramps or another body height (and motion that
# was imported); pushes and how they are taken; a change from one gait to another; noise on the applied targets
# while the labels stay clean; standing.
SPLITS = ("steady", "varied", "recovery", "transition", "perturbed", "stand")
TRAINING_SPLITS = ("steady", "varied", "recovery")


@dataclass(frozen=True)
class Clip:
    """One motion of T control steps. Arrays are float32 unless said otherwise."""

    dt: float  # s between rows
    gait: str  # for a transition the one it ends in
    frequency_hz: float  # stride frequency asked for, 0 for standing
    command: np.ndarray  # (3,) vx, vy in m/s and yaw rate in rad/s; (T, 3) where it changes
    base_position: np.ndarray  # (T, 3) m, world
    base_quaternion: np.ndarray  # (T, 4) base to world
    joint_position: np.ndarray  # (T, 12) rad
    joint_velocity: np.ndarray  # (T, 12) rad/s
    base_linear_velocity: np.ndarray  # (T, 3) m/s, base frame
    base_angular_velocity: np.ndarray  # (T, 3) rad/s, base frame
    foot_position: np.ndarray  # (T, 4, 3) m, base frame, centre of the foot's sphere
    foot_velocity: np.ndarray  # (T, 4, 3) m/s, time derivative of foot_position
    foot_contact: np.ndarray  # (T, 4) bool
    joint_target: np.ndarray  # (T, 12) rad, the expert's answer to this state
    joint_target_applied: np.ndarray  # (T, 12) rad, what the PD controller received
    joint_torque: np.ndarray  # (T, 12) N m, mean over the control step that follows
    joint_names: tuple[str, ...] = JOINT_NAMES
    foot_names: tuple[str, ...] = FOOT_NAMES
    split: str = "steady"  # one of SPLITS
    seed: int = 0  # of its random commands, pushes or noise
    previous_gait: str = ""  # of a transition: the gait before `switch_step`
    switch_step: int = 0  # row from which `gait` is asked for
    source: str = EXPERT  # who made it: the expert, or the format of the file it was imported from
    # (T, 4) fraction of the control step before that each foot stood; in no file: `with_foot_stance` finds it
    foot_stance: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.joint_position)

    @property
    def holds_command(self) -> bool:
        """Whether the command is one twist held throughout, so that means can be judged."""
        return self.command.ndim == 1

    @property
    def is_steady(self) -> bool:
        """Whether the clip shows nothing but a gait at one twist, undisturbed and at its usual height."""
        return self.holds_command and self.split == "steady"

    @property
    def has_targets(self) -> bool:
        """Whether targets and torques are the expert's; imported motion holds the next row's joints and zeros."""
        return self.source == EXPERT


def amp_state(clip: Clip) -> np.ndarray:
    """The paper's states of the discriminators, (T, 43) float32, SI units, laid out as in `camp.robots.amp_state`."""
    values = {
        "joint_position": clip.joint_position,
        "joint_velocity": clip.joint_velocity,
        "base_linear_velocity": clip.base_linear_velocity,
        "base_angular_velocity": clip.base_angular_velocity,
        "base_height": clip.base_position[:, 2:],
        "foot_position": clip.foot_position.reshape(len(clip), -1),
    }
    return np.concatenate(amp_parts(values), axis=1).astype(np.float32)


def discriminator_state(clip: Clip) -> np.ndarray:
    """What the discriminators see, (T, S) float32: the AMP states and, where the clip has it, the feet's stance."""
    state = amp_state(clip)
    return state if clip.foot_stance is None else np.concatenate([state, clip.foot_stance], axis=1)
