"""Generating clips: the expert walks in the learner's simulation, through its PD, and is recorded."""

from __future__ import annotations

import multiprocessing
import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from camp.errors import CampError, ClipError
from camp.motion.clips import Clip, load_clip, save_clip
from camp.motion.expert import CONTROL_PERIOD, Expert
from camp.motion.gaits import GaitSchedule
from camp.motion.recording import Answer, Recorder
from camp.motion.requests import ClipRequest
from camp.motion.validate import check_clip
from camp.robots.go2 import DEFAULT_JOINT_POSITION, STANDING_HEIGHT, load_model

CLIP_STEPS = 200  # rows, 4 s
WARM_UP = 3.0  # s of walking before a steady clip is recorded
STAND_DURATION = 0.2  # s before the gait begins
NOISE_ONSET = 0.3  # s of walking before noise sets in
NOISE_CORRELATION = 0.5  # from one control step to the next
_FALLEN_HEIGHT, _FALLEN_UPRIGHTNESS = 0.12, 0.5  # m; cosine of the tilt


class AppliedNoise:
    """Correlated noise (first-order autoregressive) of a given standard deviation, (12,) rad."""

    def __init__(self, std: float, seed: int) -> None:
        self._std, self._rng, self._value = std, np.random.default_rng(seed), np.zeros(12)

    def draw(self) -> np.ndarray:
        """The next value."""
        fresh = self._std * np.sqrt(1.0 - NOISE_CORRELATION**2) * self._rng.standard_normal(12)
        self._value = NOISE_CORRELATION * self._value + fresh
        return self._value


def generate_clip(request: ClipRequest, steps: int = CLIP_STEPS) -> Clip:
    """Walk and record `steps` control steps. Deterministic. Raises ClipError where the robot falls."""
    model = load_model()
    data = _standing(model)
    expert = Expert(data, GaitSchedule(request.gait, request.frequency_hz), STAND_DURATION)
    noise = AppliedNoise(request.noise_std, request.seed)
    recorder = Recorder(model)
    first_time = -np.inf if request.from_standing else WARM_UP
    command = np.array(request.command)
    while len(recorder) < steps:
        started = expert.time >= first_time - 1e-6
        noisy = expert.time >= NOISE_ONSET
        state, previous = np.r_[data.qpos, data.qvel], data.ctrl.copy()
        try:
            target = expert.answer(data, command)
        except ValueError as error:
            raise _fall(request, expert) from error
        applied = target + noise.draw() if noisy else target
        torque = _apply(model, data, applied)
        if started:
            recorder.add(state, previous, Answer(target, applied, torque, expert.command))
        if _has_fallen(data):
            raise _fall(request, expert)
    return recorder.clip(request.gait, request.frequency_hz, CONTROL_PERIOD, steady=not request.from_standing)


@dataclass(frozen=True)
class Outcome:
    """What became of a request. status: made, kept (it was there already) or failed; seconds: wall time."""

    request: ClipRequest
    status: str
    message: str = ""
    seconds: float = 0.0


def generate_dataset(
    requests: Sequence[ClipRequest], folder: Path, workers: int, overwrite: bool = False
) -> Iterator[Outcome]:
    """Generate clips into a folder, yielding each outcome as it comes, in any order.

    Clips that exist and are valid are kept unless `overwrite`; a failure does not stop the others. Work is
    done in child processes with single-threaded linear algebra, so that results do not depend on the number
    of workers.
    """
    folder = Path(folder)
    jobs = []
    for request in requests:
        if not overwrite and _is_there(request, folder):
            yield Outcome(request, "kept")
        else:
            jobs.append((request, folder))
    if not jobs:
        return
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"  # inherited by the children
    with multiprocessing.get_context("spawn").Pool(min(workers, len(jobs))) as pool:
        yield from pool.imap_unordered(_work, jobs)


def _work(job: tuple[ClipRequest, Path]) -> Outcome:
    request, folder = job
    start = time.perf_counter()
    try:
        clip = generate_clip(request)
        bad = [check for check in check_clip(clip) if not check.passed]
        if bad:
            raise ClipError(
                "; ".join(f"{check.name} {check.value:.3g} is not {check.bound} {check.limit:.3g}" for check in bad)
            )
        save_clip(folder / f"{request.name}.npz", clip)
    except CampError as error:
        return Outcome(request, "failed", str(error), time.perf_counter() - start)
    return Outcome(request, "made", seconds=time.perf_counter() - start)


def _is_there(request: ClipRequest, folder: Path) -> bool:
    try:
        load_clip(folder / f"{request.name}.npz")
    except ClipError:
        return False
    return True


def _standing(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = [0.0, 0.0, STANDING_HEIGHT, 1.0, 0.0, 0.0, 0.0, *DEFAULT_JOINT_POSITION]
    data.ctrl[:] = DEFAULT_JOINT_POSITION
    mujoco.mj_forward(model, data)
    return data


def _apply(model: mujoco.MjModel, data: mujoco.MjData, target: np.ndarray) -> np.ndarray:
    """Hold a joint target for one control step; returns the mean torque (12,) in N m."""
    data.ctrl[:] = target
    steps = round(CONTROL_PERIOD / model.opt.timestep)
    torque = np.zeros(12)
    for _ in range(steps):
        mujoco.mj_step(model, data)
        torque += data.actuator_force / steps
    return torque


def _has_fallen(data: mujoco.MjData) -> bool:
    upright = data.body("base").xmat[8]
    return bool(data.qpos[2] < _FALLEN_HEIGHT or upright < _FALLEN_UPRIGHTNESS)


def _fall(request: ClipRequest, expert: Expert) -> ClipError:
    return ClipError(
        f"{request.name}: the robot fell {expert.time:.1f} s after the gait began, "
        f"command {request.command}; ask for a slower command or less noise"
    )
