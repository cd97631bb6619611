"""The subcommands `import` and `export` of `python -m camp.dataset`."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from camp.common.errors import ClipError
from camp.common.files import folder_lock
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import is_near
from camp.metrics.gait import measure_gait
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.exchange import exporter
from camp.motion.exchange.convert import FORMATS, import_motion
from camp.motion.exchange.motion import QUATERNION_ORDERS, ImportOptions
from camp.robots.robot import Robot

COMMANDS = ("import", "export")
IMPORTED_FOLDER = Path("outputs/motions/imported")
FEWEST_STRIDES = 2  # of a clip that shows a rhythm


def add_exchange(commands: argparse._SubParsersAction) -> None:
    """Add both subcommands; `options.command` tells which was given."""
    reader = commands.add_parser("import", help="read a motion of another project as a clip")
    reader.add_argument("file", type=Path, help="the file to read")
    reader.add_argument("--format", required=True, choices=FORMATS, help="layout of the file (docs/motions.md)")
    reader.add_argument("--gait", required=True, choices=tuple(GAIT_PHASES), help="gait of the motion")
    reader.add_argument("--rate", type=float, metavar="HZ", help="frame rate, instead of the file's")
    reader.add_argument("--frequency", type=float, metavar="HZ", help="stride frequency (default: measured)")
    reader.add_argument("--steady", type=float, nargs=3, metavar=("VX", "VY", "WZ"), help="its constant command")
    reader.add_argument("--leg-order", type=_legs, metavar="FR,FL,...", help="order of the legs, if not the format's")
    reader.add_argument("--foot-order", type=_legs, metavar="FR,FL,...", help="order of the feet, if not the joints'")
    reader.add_argument("--quaternion-order", metavar="|".join(QUATERNION_ORDERS), help="if not the format's")
    reader.add_argument(
        "--velocity-frame",
        type=_frames,
        default=("base", "base"),
        metavar="FRAME[,FRAME]",
        help="base or world, of the root's velocities: both, or linear,angular (MuJoCo: world,base)",
    )
    reader.add_argument("--trust-joints", action="store_true", help="recompute feet that disagree with the joints")
    reader.add_argument("--derive-velocities", action="store_true", help="compute velocities from positions")
    reader.add_argument("--ground", action="store_true", help="shift the motion until the lowest feet stand on z = 0")
    reader.add_argument("--name", help="name of the clip, without suffix (default: gait and file name)")
    reader.add_argument("--folder", type=Path, default=IMPORTED_FOLDER, help="output folder (default: %(default)s)")
    reader.add_argument("--overwrite", action="store_true", help="replace an existing clip")
    reader.set_defaults(command="import")
    writer = commands.add_parser("export", help="write a clip in another project's format")
    writer.add_argument("clip", type=Path, help="the clip's .npz")
    writer.add_argument("output", type=Path, help="the file to write")
    writer.add_argument("--format", required=True, choices=exporter.FORMATS, help="layout of the file")
    writer.add_argument("--overwrite", action="store_true", help="replace a file of that name")
    writer.set_defaults(command="export")


def run_exchange(robot: Robot, options: argparse.Namespace) -> int:
    """Carry out `import` or `export`; returns the exit code. Raises CampError for input that cannot be used."""
    return _export(options) if options.command == "export" else _import(robot, options)


def _export(options: argparse.Namespace) -> int:
    _refuse_existing(options.output, options.overwrite, "another name")
    clip = load_clip(options.clip)
    exporter.export_amp(options.output, clip)
    print(f"{options.output}: {len(clip)} frames at {1 / clip.dt:g} Hz, legs {','.join(exporter.LEG_ORDER)}")
    return 0


def _import(robot: Robot, options: argparse.Namespace) -> int:
    name = (options.name or _name(options)).removesuffix(".npz")
    if Path(name).name != name:
        raise ClipError(f"--name {name!r}: give a file's name, and its folder with --folder")
    output = options.folder / f"{name}.npz"
    _refuse_existing(output, options.overwrite, "another --name")
    clip = import_motion(
        options.file,
        options.format,
        ImportOptions(
            robot=robot,
            gait=options.gait,
            rate_hz=options.rate,
            frequency_hz=options.frequency,
            command=tuple(options.steady) if options.steady else None,
            leg_order=options.leg_order,
            foot_order=options.foot_order,
            quaternion_order=options.quaternion_order,
            velocity_frames=options.velocity_frame,
            trust_joints=options.trust_joints,
            derive_velocities=options.derive_velocities,
            ground=options.ground,
        ),
    )
    with folder_lock(options.folder):
        _refuse_existing(output, options.overwrite, "another --name")  # as it may be by now
        save_clip(output, clip)
    print(f"{output}: {_summary(clip)}")
    for note in _notes(clip):
        print(f"note: {note}")
    return 0


def _refuse_existing(output: Path, overwrite: bool, other: str) -> None:
    if output.exists() and not overwrite:
        raise ClipError(f"{output} is there already; pass --overwrite or {other}")


def _legs(text: str) -> tuple[str, ...]:
    return tuple(leg.strip().upper() for leg in text.split(","))


def _frames(text: str) -> tuple[str, str]:
    """Of the linear and the angular velocity; one name stands for both."""
    frames = [frame.strip().lower() for frame in text.split(",")]
    if len(frames) > 2:
        raise argparse.ArgumentTypeError(f"{text}: name one frame, or two as linear,angular")
    return frames[0], frames[-1]


def _name(options: argparse.Namespace) -> str:
    """Kine2Go calls every file motion.npy: its folder tells them apart."""
    own = options.file.resolve().parent.name if options.file.stem == "motion" else ""
    return f"{options.gait}_{own or options.file.stem}"


def _summary(clip: Clip) -> str:
    speed = clip.command if clip.holds_command else clip.command.mean(axis=0)
    return (
        f"{len(clip)} rows ({len(clip) * clip.dt:.2f} s), {clip.gait} at {clip.frequency_hz:.2f} Hz, "
        f"mean vx {speed[0]:.2f} vy {speed[1]:.2f} m/s wz {speed[2]:.2f} rad/s"
    )


def _notes(clip: Clip) -> list[str]:
    """What a user may not know of the clip: it trains all the same."""
    measured = measure_gait(clip.foot_contact[None], clip.dt)
    gait, frequency = measured.label[0], measured.frequency_hz[0]
    strides = (len(clip) - 1) * clip.dt * clip.frequency_hz
    notes = []
    if gait != clip.gait:
        notes.append(f"by its contacts it is '{gait}', not {clip.gait}")
    if np.isfinite(frequency) and not is_near(frequency, clip.frequency_hz):
        notes.append(f"by its contacts it steps at {frequency:.2f} Hz, not {clip.frequency_hz:g} Hz")
    if strides < FEWEST_STRIDES:
        notes.append(
            f"{len(clip)} rows are {len(clip) - 1} transitions, {strides:.1f} strides: fewer than {FEWEST_STRIDES} "
            "show no rhythm"
        )
    return notes
