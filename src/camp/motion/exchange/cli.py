"""The subcommands `import` and `export` of `python -m camp.dataset`."""

from __future__ import annotations

import argparse
from pathlib import Path

from camp.common.errors import ClipError
from camp.gaits.schedule import GAIT_PHASES
from camp.metrics.gait import measure_gait
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.exchange import exporter
from camp.motion.exchange.convert import FORMATS, import_motion
from camp.motion.exchange.motion import ImportOptions

COMMANDS = ("import", "export")
IMPORTED_FOLDER = Path("outputs/motions/imported")


def add_exchange(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add both subcommands; `options.command` tells which was given."""
    reader = commands.add_parser("import", help="read a motion of another project as a clip")
    reader.add_argument("file", type=Path, help="what to read")
    reader.add_argument("--format", required=True, choices=FORMATS, help="layout of the file (docs/motions.md)")
    reader.add_argument("--gait", required=True, choices=tuple(GAIT_PHASES), help="which gait it shows")
    reader.add_argument("--rate", type=float, metavar="HZ", help="frames per s, in place of the file's own")
    reader.add_argument("--frequency", type=float, metavar="HZ", help="stride frequency (default: measured)")
    reader.add_argument("--steady", type=float, nargs=3, metavar=("VX", "VY", "WZ"), help="the command it follows")
    reader.add_argument("--leg-order", type=_legs, metavar="FR,FL,...", help="legs of the file, where not its format's")
    reader.add_argument("--velocity-frame", choices=("base", "world"), default="base", help="of amp root velocities")
    reader.add_argument("--trust-joints", action="store_true", help="compute the feet where the file's do not fit")
    reader.add_argument("--derive-velocities", action="store_true", help="compute them from the positions")
    reader.add_argument("--ground", action="store_true", help="shift the motion until the lowest feet stand on z = 0")
    reader.add_argument("--name", help="of the clip's file, without suffix (default: gait and the file's own)")
    reader.add_argument("--folder", type=Path, default=IMPORTED_FOLDER, help="where it goes (default: %(default)s)")
    reader.add_argument("--overwrite", action="store_true", help="replace a clip of that name")
    reader.set_defaults(command="import")
    writer = commands.add_parser("export", help="write a clip in another project's format")
    writer.add_argument("clip", type=Path, help="the clip's .npz")
    writer.add_argument("output", type=Path, help="the file to write")
    writer.add_argument("--format", required=True, choices=exporter.FORMATS, help="layout of the file")
    writer.set_defaults(command="export")


def run_exchange(options: argparse.Namespace) -> int:
    """Carry out `import` or `export`; returns the exit code. Raises ClipError for input that cannot be used."""
    if options.command == "export":
        clip = load_clip(options.clip)
        exporter.export_amp(options.output, clip)
        print(f"{options.output}: {len(clip)} frames at {1 / clip.dt:g} Hz, legs {','.join(exporter.LEG_ORDER)}")
        return 0
    output = options.folder / f"{options.name or _name(options)}.npz"
    if output.exists() and not options.overwrite:
        raise ClipError(f"clip {output} is there already; pass --overwrite or another --name")
    clip = import_motion(
        options.file,
        options.format,
        ImportOptions(
            gait=options.gait,
            rate_hz=options.rate,
            frequency_hz=options.frequency,
            command=tuple(options.steady) if options.steady else None,
            leg_order=options.leg_order,
            velocity_frame=options.velocity_frame,
            trust_joints=options.trust_joints,
            derive_velocities=options.derive_velocities,
            ground=options.ground,
        ),
    )
    save_clip(output, clip)
    print(f"{output}: {_summary(clip)}")
    return 0


def _legs(text: str) -> tuple[str, ...]:
    return tuple(leg.strip().upper() for leg in text.split(","))


def _name(options: argparse.Namespace) -> str:
    """Kine2Go calls every file motion.npy: its folder tells them apart."""
    own = options.file.parent.name if options.file.stem == "motion" else ""
    return f"{options.gait}_{own or options.file.stem}"


def _summary(clip: Clip) -> str:
    measured = measure_gait(clip.foot_contact[None], clip.dt)
    speed = clip.command if clip.holds_command else clip.command.mean(axis=0)
    text = (
        f"{len(clip)} rows ({len(clip) * clip.dt:.2f} s), {clip.gait} at {clip.frequency_hz:.2f} Hz, "
        f"mean vx {speed[0]:.2f} vy {speed[1]:.2f} m/s wz {speed[2]:.2f} rad/s"
    )
    if measured.label[0] != clip.gait:
        text += f"; note: by its contacts it is '{measured.label[0]}', not {clip.gait}"
    return text
