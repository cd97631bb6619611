"""What eval.npz holds, for the figures and for whoever wants to look closer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camp.evaluation.reading import Reading
from camp.evaluation.recording import Recording
from camp.evaluation.switching import Switches
from camp.gaits.skills import Skill, names


def common_arrays(period_s: float, skills: Sequence[Skill]) -> dict[str, np.ndarray]:
    """Names of the labels and s between rows."""
    return {"period": np.array(period_s), "skills": np.array(names(skills))}


def grid_arrays(reading: Reading, commands: Sequence[Sequence[float]]) -> dict[str, np.ndarray]:
    """The grid by skill and command, (K, G, ...); contacts from the start, the rest without the discarded seconds."""
    grid, recording, gait = (len(reading.skills), len(commands)), reading.recording, reading.gait
    return {
        "commands": np.array(commands, dtype=np.float32),
        "contact": recording.step_contact.reshape(*grid, -1, 4),
        "steps_upright": recording.steps_upright.reshape(grid),
        "phase": gait.phase.reshape(*grid, 4),
        "frequency_hz": gait.frequency_hz.reshape(grid),
        "duty": gait.duty.reshape(*grid, 4),
        "flight_fraction": gait.flight.reshape(grid),
        "performed": reading.shown.reshape(grid),
        "mean_velocity": reading.velocity.reshape(*grid, 3),
    }


def walk_arrays(prefix: str, reading: Reading) -> dict[str, np.ndarray]:
    """Random walks one by one (N, ...): what was asked for, what was shown, and which criteria failed."""
    return {
        f"{prefix}_skill": reading.wanted.astype(np.int16),
        f"{prefix}_command": reading.command,
        f"{prefix}_performed": reading.shown,
        f"{prefix}_failed": np.stack(list(reading.failed.values()), axis=1),
        f"{prefix}_frequency_hz": reading.gait.frequency_hz.astype(np.float32),
        f"{prefix}_duty": reading.gait.duty.astype(np.float32),
        f"{prefix}_flight_fraction": reading.gait.flight.astype(np.float32),
        f"{prefix}_mean_velocity": reading.velocity.astype(np.float32),
    }


def switching_arrays(recording: Recording, switches: Switches) -> dict[str, np.ndarray]:
    """The first sequence in full (T, ...), the contacts of all W of them (W, T, 4), and the M switches."""
    true, contact = switches.true, recording.step_contact
    return {
        "switch_steps_upright": recording.steps_upright[0],
        "skill_switch_contact": contact[0],
        "skill_switch_skill": recording.skill[0],
        "skill_switch_joint_position": recording.joint_position[0],
        "skill_switch_joint_target": recording.joint_target[0],
        "skill_switch_velocity": recording.velocity[0],
        "skill_switch_command": np.repeat(recording.command[:1], recording.steps, axis=0),
        "switches_contact": contact,
        "switches_skill": recording.skill.astype(np.int16),
        "switches_command": recording.command,
        "switch_sequence": switches.robot[true],
        "switch_step": switches.begin[true],
        "switch_from": switches.before[true],
        "switch_to": switches.after[true],
        "switch_seconds": switches.seconds[true],
    }
