"""Files with all that is needed to simulate a step again in which a robot's simulation diverged.

One .npz each, without pickled objects: the arrays of `QuadrupedEnv` for one robot, and ``about``, a JSON text.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camp.common import distributed
from camp.common.archive import read_arrays
from camp.common.commands import command
from camp.common.errors import CheckpointError
from camp.common.files import whole_file
from camp.common.foreign import foreign_file
from camp.config.schema import Config
from camp.envs.divergence import ROBOT
from camp.gaits.skills import names
from camp.runs.folder import DIVERGED

MOST_DUMPS = 10  # of one process in a run folder, at most one an iteration: the first are what tells most
_ABOUT = "about"
_NEEDED = {  # arrays and their shapes; what else stands in a file is the simulator's own
    "action": (12,),
    "joint_target": (12,),
    "command": (3,),
    "reached.qpos": (19,),
    "reached.qvel": (18,),
    "before.qpos": (19,),
    "before.qvel": (18,),
}


@dataclass(frozen=True)
class About:
    """What the arrays do not say."""

    iteration: int
    rank: int
    env: int  # the robot's number among its rank's
    step: int  # control steps into the episode
    skill: str
    robot: str
    kp: list[float]  # N m/rad: hip, thigh, calf
    kd: list[float]  # N m s/rad
    control_period_s: float
    physics_timestep_s: float
    backend: str


@dataclass(frozen=True)
class Dump:
    """One file."""

    about: About
    arrays: dict[str, np.ndarray]

    def part(self, name: str) -> dict[str, np.ndarray]:
        """The arrays ``<name>.<key>`` by their keys: ``before``, ``dynamics``, ``reached``."""
        prefix = f"{name}."
        return {key.removeprefix(prefix): array for key, array in self.arrays.items() if key.startswith(prefix)}


def save_dump(run: Path, iteration: int, case: Mapping[str, np.ndarray], config: Config) -> list[str]:
    """Write a case of `camp.envs.divergence` into the run folder; returns lines to print.

    None beyond MOST_DUMPS. What cannot be written is said, too: training goes on without it.
    """
    rank, skills = distributed.rank(), names(config.motion.skill_set())
    folder, suffix = run / DIVERGED, f"rank{rank}.npz"
    if len(list(folder.glob(f"*_{suffix}"))) >= MOST_DUMPS:
        return []
    about = About(
        iteration=iteration,
        rank=rank,
        env=int(case[ROBOT].item()),
        step=int(case["step"].item()),
        skill=skills[int(case["skill"].item())],
        robot=config.robot.name,
        kp=list(config.robot.kp),
        kd=list(config.robot.kd),
        control_period_s=config.env.control_period_s,
        physics_timestep_s=config.sim.physics_timestep_s,
        backend=config.sim.backend,
    )
    arrays: dict[str, Any] = {_ABOUT: np.array(json.dumps(asdict(about))), **case}
    path = folder / f"iteration_{iteration:08d}_{suffix}"
    try:
        with whole_file(path) as file:
            np.savez(file, **arrays)
    except OSError as error:
        return [f"robot {about.env} diverged; its state could not be kept ({path}: {error.strerror or error})"]
    return [f"robot {about.env} diverged; see what happened: {command('camp.replay', str(path))}"]


def load_dump(path: Path) -> Dump:
    """Raises CheckpointError in one line for a file that is missing, damaged or no dump."""
    remedy = f"name an .npz of a run folder's {DIVERGED}/"
    with foreign_file(path, f"dump {path}: unreadable", remedy, CheckpointError):
        arrays = read_arrays(path)
        about = About(**json.loads(str(arrays.pop(_ABOUT))))
        for name, shape in _NEEDED.items():
            if arrays[name].shape != shape:
                raise ValueError(f"{name} has the shape {arrays[name].shape}, not {shape}")
        bad = [name for name in arrays if name.startswith(("before.", "dynamics.")) and not _finite(arrays[name])]
        if bad:
            raise ValueError(f"{bad[0]} is not finite")
        if not 0.0 < about.physics_timestep_s <= about.control_period_s <= 1.0 or len(about.kp + about.kd) != 6:
            raise ValueError(f"about = {about}")
        return Dump(about, arrays)


def _finite(array: np.ndarray) -> bool:
    return array.dtype.kind == "f" and bool(np.isfinite(array).all())
