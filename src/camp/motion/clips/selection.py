"""Which clips of a folder show which skill, and what to ask for where one has none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from camp.common.commands import command
from camp.common.errors import ClipError
from camp.gaits.schedule import GRID_STEPS
from camp.gaits.skills import FREQUENCY_TOLERANCE, Skill, is_near, label_of, skill_set
from camp.motion.clips.clip import STAND, TRAINING_SPLITS

_LONGEST_LIST = 12  # frequencies of a gait that a message names


class ClipLabel(NamedTuple):
    """What a clip says it shows."""

    gait: str
    split: str
    frequency_hz: float


def select(
    folder: Path, labels: Mapping[Path, ClipLabel], skills: Sequence[Skill], frequencies_hz: Sequence[float]
) -> list[Path]:
    """The clips for training that show one of the skills near one of the stride frequencies, in the given order.

    Raises ClipError where a skill has none.
    """
    usable = {path: label for path, label in labels.items() if label.split in TRAINING_SPLITS and label.gait != STAND}
    shown = {path: _shown(label, skills, frequencies_hz) for path, label in usable.items()}
    for index, skill in enumerate(skills):
        if index not in shown.values():
            raise ClipError(_nothing_shows(skill, folder, usable.values(), skills, frequencies_hz))
    return [path for path, index in shown.items() if index is not None]


def _shown(label: ClipLabel, skills: Sequence[Skill], frequencies_hz: Sequence[float]) -> int | None:
    if not any(is_near(label.frequency_hz, wanted) for wanted in frequencies_hz):
        return None
    return label_of(label.gait, label.frequency_hz, skills)


def _nothing_shows(
    skill: Skill,
    folder: Path,
    labels: Iterable[ClipLabel],
    skills: Sequence[Skill],
    frequencies_hz: Sequence[float],
) -> str:
    found = sorted({(label.gait, label.frequency_hz) for label in labels})
    if not found:
        return f"no clip in {folder} is for training ({', '.join(TRAINING_SPLITS)}); generate some with " + (
            f"`{command('camp.dataset', '--folder', str(folder))}`"
        )
    wanted = [skill.frequency_hz] if skill.frequency_hz is not None else frequencies_hz
    return (
        f"skill {skill.name!r}: no clip in {folder} is a {skill.gait} within {FREQUENCY_TOLERANCE:.0%} of "
        f"{_join(wanted)} Hz (motion.frequencies_hz; found: {_describe(found)}); train with "
        f"{' '.join(what_would_load(found, skills))}"
    )


def _describe(found: Sequence[tuple[str, float]]) -> str:
    """Such as "trot at 1.57, 1.82 Hz, pace at 2 Hz"."""
    gaits: dict[str, list[float]] = {}
    for gait, frequency in found:
        gaits.setdefault(gait, []).append(frequency)
    return ", ".join(f"{gait} at {_join(frequencies)} Hz" for gait, frequencies in gaits.items())


def _join(frequencies: Sequence[float]) -> str:
    text = ", ".join(dict.fromkeys(f"{frequency:.3g}" for frequency in frequencies[:_LONGEST_LIST]))
    return f"{text}, ... {frequencies[-1]:.3g}" if len(frequencies) > _LONGEST_LIST else text


def what_would_load(found: Sequence[tuple[str, float]], skills: Sequence[Skill]) -> list[str]:
    """Overrides with which training takes clips of gaits and stride frequencies (Hz) that were found.

    As near to the skills that were asked for as can be: their gaits where one was found, a label for each frequency
    where that was wanted and every gait was found at each. The expert's own frequencies come first, for only these
    can be imitated in a warm start.
    """
    asked = dict.fromkeys(skill.gait for skill in skills)
    gaits = [gait for gait in asked if gait in dict(found)] or list(dict(found))
    measured = sorted({frequency for gait, frequency in found if gait in gaits})
    candidates = [*GRID_STEPS, *dict.fromkeys(round(frequency, 2) for frequency in measured)]
    own = [(gait, frequency) for gait, frequency in found if gait in gaits]
    labels = "gait_frequency" if any(skill.frequency_hz is not None for skill in skills) else "gait"
    frequencies = _cover(own, gaits, labels, candidates)
    if not frequencies:
        labels, frequencies = "gait", _cover(own, gaits, "gait", candidates)
    overrides = [
        f"motion.skills=[{','.join(gaits)}]",
        f"motion.labels={labels}",
        f"motion.frequencies_hz=[{','.join(f'{frequency:g}' for frequency in sorted(frequencies))}]",
    ]
    if set(frequencies) <= GRID_STEPS.keys():
        return overrides
    return ["run=scratch", "env.foot_stance=false", *overrides]  # imported clips have no joint targets


def _cover(
    found: Sequence[tuple[str, float]], gaits: Sequence[str], labels: str, candidates: Sequence[float]
) -> list[float]:
    """Those candidates (Hz) that take in the clips found, each a new one, such that every skill is left with one."""
    chosen: list[float] = []
    for candidate in candidates:
        new = [one for one in found if is_near(one[1], candidate) and not any(is_near(one[1], c) for c in chosen)]
        skills = skill_set(gaits, labels, [*chosen, candidate])
        shown = {_shown(ClipLabel(gait, "", hz), skills, [*chosen, candidate]) for gait, hz in found}
        if new and (labels == "gait" or set(range(len(skills))) <= shown):
            chosen.append(candidate)
    return chosen
