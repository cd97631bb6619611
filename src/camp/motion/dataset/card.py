"""The data set's card: a README beside the clips, written from the clips themselves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from camp.common.errors import ClipError
from camp.common.files import write_text
from camp.common.markdown import pipe_table
from camp.gaits.gait import GAITS
from camp.motion.clips.clip import SPLITS, STAND, TRAINING_SPLITS, Clip
from camp.motion.clips.consistency import ClipCheck
from camp.motion.dataset.report import Cell, worst_by_cell
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from camp.robots.registry import DEFAULT_ROBOT
from camp.robots.robot import Robot

CARD_NAME = "README.md"
_MARK = "Written by `python -m camp.dataset card`; do not edit."

SPLIT_MEANING = {
    "steady": "one command held throughout, recorded after 3 s of walking",
    "varied": "speeding up, slowing down into reverse, random sequences of commands, lower and higher bodies",
    "recovery": "two pushes of .25 to .55 m/s in random directions, and how the gait takes them",
    "transition": "from one gait into another, .15 s on all four feet between them; `gait` is the later one",
    "perturbed": "noise on the applied targets, clean answers as labels, from standing; made on demand",
    "stand": "standing at three heights, undisturbed and pushed; no skill of its own",
}

# Key: shape, unit, meaning. T is the number of rows.
KEYS: dict[str, tuple[str, str, str]] = {
    "dt": ("()", "s", "time between rows"),
    "gait": ("()", "text", "trot, pace, bound, pronk or stand; of a transition the later one"),
    "frequency_hz": ("()", "Hz", "stride frequency asked for; 0 for standing"),
    "command": ("(3,) or (T, 3)", "m/s, m/s, rad/s", "vx, vy, yaw rate asked for; (T, 3) where it changes"),
    "base_position": ("(T, 3)", "m", "base origin in the world, floor at z = 0, beginning at x = y = 0"),
    "base_quaternion": ("(T, 4)", "-", "base to world, w x y z"),
    "joint_position": ("(T, 12)", "rad", "in the order of `joint_names`"),
    "joint_velocity": ("(T, 12)", "rad/s", ""),
    "base_linear_velocity": ("(T, 3)", "m/s", "of the base origin, in the base frame"),
    "base_angular_velocity": ("(T, 3)", "rad/s", "in the base frame"),
    "foot_position": ("(T, 4, 3)", "m", "centres of the feet's spheres in the base frame"),
    "foot_velocity": ("(T, 4, 3)", "m/s", "time derivative of `foot_position`"),
    "foot_contact": ("(T, 4)", "bool", "ground reaction above 1 N"),
    "joint_target": ("(T, 12)", "rad", "the expert's answer to this row's state"),
    "joint_target_applied": ("(T, 12)", "rad", "what the PD controller held for the following `dt`"),
    "joint_torque": ("(T, 12)", "N m", "mean over the following `dt`"),
    "joint_names": ("(12,)", "text", ""),
    "foot_names": ("(4,)", "text", ""),
    "split": ("()", "text", "see above"),
    "seed": ("()", "int", "of random commands, pushes or noise"),
    "previous_gait": ("()", "text", "of a transition, else empty"),
    "switch_step": ("()", "int", "row from which `gait` is asked for"),
    "source": ("()", "text", "expert, or the format of the file it was imported from (then without targets)"),
}

_COLUMNS = {
    "frequency error": "freq. err.",
    "phase error (strides)": "phase err.",
    "contact match": "contacts",
    "duty error (strides)": "duty err.",
    "flight error (strides)": "flight err.",
    "speed error (m/s)": "speed err.",
    "turn error (rad/s)": "turn err.",
    "stance slip (m/s)": "slip",
    "largest tilt (rad)": "tilt",
    "torque / limit": "torque",
    "joint speed / limit": "joint speed",
    "joint beyond range (rad)": "beyond range",
    "replay (rad)": "replay",
}


def dataset_card(robot: Robot, clips: Mapping[str, Clip], results: Mapping[str, Sequence[ClipCheck]], size: int) -> str:
    """The card of a robot's clips as Markdown; clips and check results by clip name, `size` of all files in bytes."""
    rows = sum(len(clip) for clip in clips.values())
    seconds = sum(len(clip) * clip.dt for clip in clips.values())
    bad = sum(not all(check.passed for check in checks) for checks in results.values())
    parts = [
        f"# Expert motions of the {robot.title}: four gaits, three stride frequencies",
        f"{len(clips)} clips, {rows:,} rows, {seconds / 60:.1f} minutes, {size / 1e6:.1f} MB. {_MARK}",
        "## What is in it",
        _counts_table(clips),
        _splits_text(clips),
        _FIGURES if robot.name == DEFAULT_ROBOT else "Figures: `python -m analysis.motions <this folder> <target>`.",
        "## How it was made",
        _making(robot),
        "## Files",
        _FILES,
        _keys_table(),
        "## Quality",
        f"`python -m camp.dataset validate` judges every clip; {len(clips) - bad} of {len(clips)} pass. "
        "Below, the worst clip of each cell; limits in the header.",
        _quality_table(worst_by_cell(clips, results), Counter(map(_cell_of, clips.values()))),
        _LIMITS,
        "## Licence",
        "MIT, as the code. The robot's masses and limits are Unitree's published ones; no motion capture was used.",
    ]
    return "\n\n".join(parts) + "\n"


def write_card(folder: Path, text: str) -> Path:
    """Put the card beside the clips; returns its path. Raises ClipError for a README that is no card."""
    path = folder / CARD_NAME
    if path.exists() and _MARK.encode() not in path.read_bytes():
        raise ClipError(f"{path} is there already, and was not written by this command; move it away")
    write_text(path, text)
    return path


def _making(robot: Robot) -> str:
    kp, kd = robot.pd_gain_p, robot.pd_gain_d
    return f"""A model-based controller walks the robot in MuJoCo: a gait schedule, a periodic single-rigid-body
reference, model predictive control over one stride, and whole-body control at every physics step. Every 20 ms
its torques are turned into joint targets for the PD controller the learner has (Kp {kp[0]:g} and
{kp[2]:g} N m/rad for calves, Kd {kd[0]:g} N m s/rad), and these targets, not the torques, move
the robot: every row is a pair of a state and an action that the learner's own interface can provably reach and
repeat. Generation is deterministic: the same request on the same platform gives the same file, whatever the
number of processes; `python -m camp.dataset` makes what is missing. Across platforms the tolerance is the validator's:
arithmetic may differ in the last bits there, contacts let that grow, and what is promised is the same motion within the
limits of the table below, not the same numbers."""


_FIGURES = """Figures of the [trot](../../../../../docs/motions/trot.png), [pace](../../../../../docs/motions/pace.png),
[bound](../../../../../docs/motions/bound.png), [pronk](../../../../../docs/motions/pronk.png) and of
[clips that are not steady](../../../../../docs/motions/examples.png): `python -m analysis.motions`."""

_LEGS, _JOINTS_OF_A_LEG = ", ".join(FOOT_NAMES), ", ".join(JOINT_NAMES[:3])
_FILES = f"""One `.npz` per clip, no pickles: `numpy.load(path, allow_pickle=False)` or
`camp.motion.clips.store.load_clip(path)`. `load_clips(robot, folder, skills)` gives the splits
{", ".join(TRAINING_SPLITS)}; `with_mirrored=True` adds the left-right mirror image of each, which is why none is
shipped. Legs are {_LEGS}; joints {_JOINTS_OF_A_LEG}, then the other legs'. Row t is the
state in which target t was given. Numbers are float32."""

_SLOWED = ", ".join(
    f"a {gait.name} at {rate:g} Hz to {speed:g} m/s" for gait in GAITS.values() for rate, speed in gait.fastest.items()
)
_LIMITS = f"""Frequency, speed and turn errors are of the means over whole strides. Phases: worst pair of legs.
Contacts: fraction of rows and feet that follow the schedule. Duty and flight: difference to the schedule's. Slip: speed
of standing feet. Torque and joint speed: largest fraction of the limit. Beyond range: negative where the joints stay
inside. Replay: the applied targets repeated open loop for half a second from the first row, joint error. What a gait
does not bear is slowed down: {_SLOWED}. Where commands change or the robot is pushed, phases may be off by .08 and
contacts match for .85 of the time."""


def _counts_table(clips: Mapping[str, Clip]) -> str:
    splits = [split for split in SPLITS if any(clip.split == split for clip in clips.values())]
    counts = Counter(map(_cell_of, clips.values()))
    order = [*GAITS, STAND]
    shown = {(gait, frequency) for _, gait, frequency in counts}
    cells = sorted(shown, key=lambda cell: (order.index(cell[0]), cell[1]))
    rows = [
        [gait, f"{frequency:g}", *(str(counts[split, gait, frequency] or "") for split in splits)]
        for gait, frequency in cells
    ]
    rows.append(["**all**", "", *(str(sum(clip.split == split for clip in clips.values())) for split in splits)])
    return pipe_table(["gait", "Hz", *splits], rows)


def _splits_text(clips: Mapping[str, Clip]) -> str:
    present = {clip.split for clip in clips.values()}
    return "\n".join(f"- **{split}**: {SPLIT_MEANING[split]}" for split in SPLITS if split in present)


def _keys_table() -> str:
    return pipe_table(["key", "shape", "unit", "meaning"], [[f"`{key}`", *values] for key, values in KEYS.items()])


def _quality_table(worst: Mapping[Cell, Mapping[str, ClipCheck]], counts: Mapping[Cell, int]) -> str:
    limits: dict[str, str] = {}
    for checks in worst.values():
        for name in _COLUMNS.keys() & checks.keys():
            limits.setdefault(name, f"{checks[name].bound} {checks[name].limit:.2g}")
    header = ["split", "gait", "Hz", "clips", *(f"{short} {limits[n]}" for n, short in _COLUMNS.items() if n in limits)]
    rows = []
    for cell, checks in worst.items():
        split, gait, frequency = cell
        values = [f"{checks[name].value:.3f}" if name in checks else "" for name in _COLUMNS if name in limits]
        rows.append([split, gait, f"{frequency:g}", str(counts[cell]), *values])
    return pipe_table(header, rows)


def _cell_of(clip: Clip) -> Cell:
    return clip.split, clip.gait, clip.frequency_hz
