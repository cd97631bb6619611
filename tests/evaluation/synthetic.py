"""Recordings made up: robots that show a gait by their contacts and do everything else as commanded."""

from __future__ import annotations

import numpy as np

from camp.evaluation.recording import Recording
from camp.gaits.gait import GAITS as GAITS_OF
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import skill_set

GAITS = ("trot", "pace", "bound", "pronk")
SKILLS = skill_set(GAITS, "gait", ())
COMMANDS = [[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]]
STEPS = 500
PERIOD = 0.02


def contacts(gait: str, frequency: float = 2.5) -> np.ndarray:
    duty = np.mean([GAITS_OF[gait].duty[2.0], GAITS_OF[gait].duty[3.0]])
    phase = np.arange(STEPS)[:, None] * PERIOD * frequency - np.array(GAIT_PHASES[gait])
    return np.mod(phase, 1.0) < duty


def recording(skill: np.ndarray, command: np.ndarray, contact: np.ndarray) -> Recording:
    """skill (R, T), command (R, 3), contact (R, T, 4): .1 m/s too fast, feet lift by 6 cm, joints on target, 15 W."""
    rows, steps = skill.shape
    wave = np.sin(np.arange(steps) * 0.1)[None, :, None]
    joints = np.broadcast_to(wave, (rows, steps, 12)).copy()
    return Recording(
        period_s=PERIOD,
        skill=skill,
        command=command,
        velocity=np.repeat(command[:, None], steps, axis=1) + np.array([0.1, 0.0, 0.0]),
        contact=contact,
        foot_height=np.where(contact, 0.0, 0.06),
        joint_target=joints,
        joint_position=joints.copy(),
        joint_velocity=np.gradient(joints, PERIOD, axis=1),
        torque=np.full((rows, steps, 2, 12), 10.0),
        power=np.full((rows, steps), 15.0),
        foot_speed=np.full((rows, steps, 4), 0.2),
        amp_state=np.zeros((rows, steps, 43)),
        qpos=np.zeros((rows, steps, 19)),
        steps_upright=np.full(rows, steps),
    )


def grid(shown: dict[str, str]) -> Recording:
    """Every skill at every command; each skill shows the gait ``shown[skill]``."""
    label = np.repeat(np.arange(len(GAITS)), len(COMMANDS))
    skill = np.repeat(label[:, None], STEPS, axis=1)
    contact = np.stack([contacts(shown[GAITS[k]]) for k in label])
    return recording(skill, np.array(COMMANDS * len(GAITS)), contact)


def sequences(orders: list[tuple[int, ...]], late: int = 0) -> Recording:
    """One robot per order of labels; each gait appears ``late`` steps behind its command."""
    each = STEPS // len(GAITS)
    skill = np.array([np.repeat(order, each) for order in orders])
    performed = np.concatenate([skill[:, :1].repeat(late, axis=1), skill[:, : STEPS - late]], axis=1)
    every = np.stack([contacts(gait) for gait in GAITS])
    contact = every[performed, np.arange(STEPS)]
    return recording(skill, np.repeat([[0.5, 0.0, 0.0]], len(orders), axis=0), contact)
