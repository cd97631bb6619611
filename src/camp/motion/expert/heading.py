"""The heading frame: a level frame that travels with the commanded twist and carries the reference motion."""

from __future__ import annotations

import numpy as np


def advance_heading(heading: np.ndarray, command: np.ndarray, duration: float) -> np.ndarray:
    """Move a pose (x, y, yaw) for `duration` s along the arc of a twist (vx, vy, wz) in its own frame."""
    velocity, turn = command[:2], command[2] * duration
    if abs(turn) < 1e-9:
        along, across = duration, 0.0
    else:
        along, across = np.sin(turn) / command[2], (1.0 - np.cos(turn)) / command[2]
    step = np.array([along * velocity[0] - across * velocity[1], across * velocity[0] + along * velocity[1]])
    cosine, sine = np.cos(heading[2]), np.sin(heading[2])
    change = [cosine * step[0] - sine * step[1], sine * step[0] + cosine * step[1], turn]
    return heading + np.array(change)


def approach_command(current: np.ndarray, goal: np.ndarray, largest_change: np.ndarray) -> np.ndarray:
    """Move a twist (3,) towards `goal` by at most `largest_change` (3,) in each component."""
    return current + np.clip(goal - current, -largest_change, largest_change)
