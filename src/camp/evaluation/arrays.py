"""What eval.npz holds, for the figures and for whoever wants to look closer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camp.evaluation.reading import GridReading
from camp.evaluation.rollout import Recording
from camp.evaluation.switching import Switches
from camp.gaits.skills import Skill, names


def common_arrays(period_s: float, skills: Sequence[Skill]) -> dict[str, np.ndarray]:
    """Names of the labels and s between rows."""
    return {"period": np.array(period_s), "skills": np.array(names(skills))}


def grid_arrays(
    recording: Recording, reading: GridReading, commands: Sequence[Sequence[float]]
) -> dict[str, np.ndarray]:
    """The grid by skill and command, (K, G, ...); contacts from the start, the rest without the discarded seconds."""
    grid = (len(reading.skills), len(commands))
    return {
        "commands": np.array(commands, dtype=np.float32),
        "contact": recording.contact.reshape(*grid, -1, 4),
        "steps_upright": recording.steps_upright.reshape(grid),
        "phase": reading.gait.phase.reshape(*grid, 4),
        "frequency_hz": reading.gait.frequency_hz.reshape(grid),
        "duty": reading.gait.duty.reshape(*grid, 4),
        "flight_fraction": reading.gait.flight_fraction.reshape(grid),
        "performed": reading.shown.reshape(grid),
        "mean_velocity": reading.velocity.reshape(*grid, 3),
    }


def switching_arrays(recording: Recording, switches: Switches) -> dict[str, np.ndarray]:
    """The first sequence in full (T, ...), the contacts of all W of them (W, T, 4), and the M switches."""
    true = switches.true
    return {
        "switch_steps_upright": recording.steps_upright[0],
        "skill_switch_contact": recording.contact[0],
        "skill_switch_skill": recording.skill[0],
        "skill_switch_joint_position": recording.joint_position[0],
        "skill_switch_joint_target": recording.joint_target[0],
        "skill_switch_velocity": recording.velocity[0],
        "skill_switch_command": recording.command[0],
        "switches_contact": recording.contact,
        "switches_skill": recording.skill.astype(np.int16),
        "switches_command": recording.command[:, 0],
        "switch_sequence": switches.robot[true],
        "switch_step": switches.begin[true],
        "switch_from": switches.before[true],
        "switch_to": switches.after[true],
        "switch_seconds": switches.seconds[true],
    }
