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

from camp.common.errors import CampError, ClipError
from camp.gaits.schedule import GaitSchedule
from camp.motion.clips.clip import STAND, Clip
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.dataset.recording import Answer, Recorder
from camp.motion.dataset.requests import PUSH_DURATION, ClipRequest
from camp.motion.dataset.validate import check_clip
from camp.motion.expert.expert import CONTROL_PERIOD, Expert
from camp.robots.robot import Robot

CLIP_STEPS = 200  # rows, 4 s
WARM_UP = 3.0  # s of walking before a clip is recorded that does not begin with standing
STAND_DURATION = 0.2  # s before the gait begins
# s, of clips that show the start: a clone sees no clock, and would learn of a longer wait to stand
SHORT_STAND_DURATION = 0.04
CHANGE_DURATION = 0.15  # s on all four feet between two gaits
CHANGE_TIME = 1.5  # s of the recording after which the next stride changes the gait
NOISE_CORRELATION = 0.5  # from one control step to the next
_FALLEN_HEIGHT, _FALLEN_UPRIGHTNESS = 0.415, 0.5  # of the standing height; cosine of the tilt
_ENDLESS = 1e3  # s, how long a standing robot waits for a gait


class AppliedNoise:
    """Correlated noise (first-order autoregressive) of a given standard deviation, (12,) rad."""

    def __init__(self, std: float, seed: int) -> None:
        self._std, self._rng, self._value = std, np.random.default_rng(seed), np.zeros(12)

    def draw(self) -> np.ndarray:
        """The next value."""
        fresh = self._std * np.sqrt(1.0 - NOISE_CORRELATION**2) * self._rng.standard_normal(12)
        self._value = NOISE_CORRELATION * self._value + fresh
        return self._value


def generate_clip(robot: Robot, request: ClipRequest, steps: int = CLIP_STEPS) -> Clip:
    """Let a robot walk and record `steps` control steps. Raises ClipError where the robot falls.

    Deterministic for one thread of linear algebra, which is what `generate_dataset` gives its processes: more of them
    sum in another order, and contacts let the last bits grow.
    """
    model = robot.load_model()
    data = _standing(robot, model)
    expert = _expert(robot, data, request)
    noise = AppliedNoise(request.noise_std, request.seed)
    recorder = Recorder(model)
    before = 0 if request.from_standing else round((STAND_DURATION + WARM_UP) / CONTROL_PERIOD)
    switch_step = 0
    for step in range(before + steps):
        time = (step - before) * CONTROL_PERIOD  # of the recording
        if request.previous_gait and not switch_step and time > CHANGE_TIME and expert.begins_stride:
            expert.change_gait(data, GaitSchedule(request.gait, request.frequency_hz), CHANGE_DURATION)
            switch_step = step - before
        state, previous = np.r_[data.qpos, data.qvel], data.ctrl.copy()
        try:
            asked = request.command_at(time)
            target = expert.answer(data, asked)
        except ValueError as error:
            raise _fall(request, expert) from error
        applied = target + noise.draw()
        data.body("base").xfrc_applied[:2] = _push_force(request, time)
        torque = _apply(model, data, applied)
        if step >= before:
            # A clone is given the command itself, not how far the expert has taken it up.
            command = asked if request.from_standing else expert.command
            recorder.add(state, previous, Answer(target, applied, torque, command))
        if _has_fallen(robot, data):
            raise _fall(request, expert)
    return recorder.clip(request, CONTROL_PERIOD, switch_step)


def _expert(robot: Robot, data: mujoco.MjData, request: ClipRequest) -> Expert:
    if request.gait == STAND:  # waits on its feet for a gait that never begins
        return Expert(robot, data, GaitSchedule("trot", 2.0), _ENDLESS, request.height)
    first = request.previous_gait or request.gait
    stand_duration = SHORT_STAND_DURATION if request.from_standing else STAND_DURATION
    return Expert(robot, data, GaitSchedule(first, request.frequency_hz), stand_duration, request.height)


def _push_force(request: ClipRequest, time: float) -> tuple[float, float]:
    """Force (x, y) in N on the base in the control step that begins at `time` s of the recording."""
    for push in request.pushes:
        if -1e-6 < time - push.time < PUSH_DURATION - 1e-6:
            return push.force
    return 0.0, 0.0


@dataclass(frozen=True)
class Outcome:
    """What became of a request. status: made, kept (it was there already) or failed; seconds: wall time."""

    request: ClipRequest
    status: str
    message: str = ""
    seconds: float = 0.0


def generate_dataset(
    robot: Robot, requests: Sequence[ClipRequest], folder: Path, workers: int, overwrite: bool = False
) -> Iterator[Outcome]:
    """Generate a robot's clips into a folder, yielding each outcome as it comes, in any order.

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
            jobs.append((robot, request, folder))
    if not jobs:
        return
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"  # inherited by the children
    with multiprocessing.get_context("spawn").Pool(min(workers, len(jobs))) as pool:
        yield from pool.imap_unordered(_work, jobs)


def _work(job: tuple[Robot, ClipRequest, Path]) -> Outcome:
    robot, request, folder = job
    start = time.perf_counter()
    try:
        clip = generate_clip(robot, request)
        bad = [check for check in check_clip(robot, clip) if not check.passed]
        if bad:
            raise ClipError("; ".join(map(str, bad)))
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


def _standing(robot: Robot, model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = [0.0, 0.0, robot.standing_height, 1.0, 0.0, 0.0, 0.0, *robot.default_joint_position]
    data.ctrl[:] = robot.default_joint_position
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


def _has_fallen(robot: Robot, data: mujoco.MjData) -> bool:
    upright = data.body("base").xmat[8]
    return bool(data.qpos[2] < round(_FALLEN_HEIGHT * robot.standing_height, 2) or upright < _FALLEN_UPRIGHTNESS)


def _fall(request: ClipRequest, expert: Expert) -> ClipError:
    return ClipError(
        f"{request.name}: the robot fell {expert.time:.1f} s after the gait began, "
        f"command {request.command}; ask for a slower command or less noise"
    )
