"""The style of all figures: sizes in inches, one colour per gait, no global matplotlib state."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from camp.common.errors import ConfigError
from camp.common.files import make_folder, whole_file
from camp.gaits.gait import GAITS
from camp.gaits.skills import split_name
from camp.metrics.gait import NO_GAIT

COLUMN, PAGE = 3.5, 7.16  # inches, the width of a column and of both in a two-column paper
SQUARE = (5.6, 5.0)
BAND = (PAGE, 2.7)
DPI = 200
INK, GREY, GRID = "#222222", "#8A8A8A", "#E5E5E5"
SEQUENTIAL = "cividis"  # colour map of magnitudes, told apart with any colour vision and in grey

GAIT_COLOURS = {gait.name: gait.colour for gait in GAITS.values()} | {NO_GAIT: "#BBBBBB"}
TERM_COLOURS = {"task": INK, "style": "#D55E00", "skill": "#56B4E9"}  # of the reward, none of them a gait's
_OTHER_COLOURS = ("#D55E00", "#56B4E9", "#F0E442", "#000000")

_RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 8.0,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "savefig.dpi": DPI,
    "pdf.fonttype": 42,  # TrueType, which publishers ask for
}


@contextmanager
def style() -> Iterator[None]:
    """Everything drawn inside has the project's look; matplotlib's settings are as before afterwards."""
    with mpl.rc_context(_RC):
        yield


def new_figure(size: tuple[float, float]) -> Figure:
    """An empty figure on the Agg backend, laid out so that labels never overlap; size (width, height) in
    inches."""
    figure = Figure(figsize=size, layout="constrained", dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def skill_colours(skills: list[str]) -> dict[str, str]:
    """Colour of each name: a gait's own, also for labels such as trot_2hz; further names take spare
    colours."""
    spare = iter(_OTHER_COLOURS * (1 + len(skills) // len(_OTHER_COLOURS)))
    return {name: GAIT_COLOURS.get(split_name(name)[0]) or next(spare) for name in skills}


def skill_shades(skills: list[str]) -> dict[str, tuple[float, float, float]]:
    """As `skill_colours`, RGB; of a gait's several skills the first is the palest, so that all can be told apart."""
    shades = {}
    for name, colour in skill_colours(skills).items():
        family = sorted(other for other in skills if split_name(other)[0] == split_name(name)[0])
        pale = 0.55 * (len(family) - 1 - family.index(name)) / max(len(family) - 1, 1)
        red, green, blue = ((1 - pale) * part + pale for part in to_rgb(colour))
        shades[name] = (red, green, blue)
    return shades


def save(figure: Figure, path: Path) -> Path:
    """Write a file, PNG or PDF by its suffix, creating its folder; returns the path.

    Raises ConfigError where it cannot be written.
    """
    make_folder(path.parent)
    kind = path.suffix.removeprefix(".")
    # Without a date the same figure is the same file.
    metadata = {"CreationDate": None} if kind == "pdf" else None
    try:
        with style(), whole_file(path) as file:
            figure.savefig(file, format=kind, dpi=DPI, metadata=metadata)
    except OSError as error:
        raise ConfigError(f"file {path}: {error.strerror or error}; free some space or remove it") from error
    return path


def save_both(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write <name>.png and <name>.pdf into the folder."""
    return [save(figure, folder / f"{name}.{kind}") for kind in ("png", "pdf")]
