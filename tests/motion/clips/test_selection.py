"""Which clips of a folder train which skill: within one tolerance, under every label, with a remedy that loads."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from camp.build import expert_clips
from camp.common.errors import ClipError, ConfigError
from camp.common.paths import assets_root, repository_root
from camp.config.compose import compose_config
from camp.gaits.skills import label_of
from camp.motion.clips.store import load_clip, save_clip

FOLDER = assets_root() / "motions" / "go2"


def folder_of(folder: Path, found: Sequence[tuple[str, float]]) -> Path:
    """Clips that say they step at these frequencies, as measured ones do."""
    for index, (gait, frequency) in enumerate(found):
        clip = replace(load_clip(FOLDER / f"{gait}_2hz_forward_0.6.npz"), frequency_hz=frequency, source="amp")
        save_clip(folder / f"{index}.npz", clip)
    return folder


def clips_for(folder: Path, *overrides: str) -> list[tuple[str, float]]:
    config = compose_config([f"motion.folder={folder}", *overrides, "motion.mirrored=false"])
    return [(clip.gait, clip.frequency_hz) for clip in expert_clips(config)]


def test_measured_frequencies_train_the_skill_that_is_near(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, [("trot", 1.57), ("trot", 1.82), ("trot", 2.15), ("trot", 2.9), ("trot", 1.8)])
    wanted = ["motion.skills=[trot]", "motion.labels=gait_frequency", "motion.frequencies_hz=[2,3]"]
    frequencies = clips_for(folder, *wanted)
    assert frequencies == [("trot", 1.82), ("trot", 2.15), ("trot", 2.9), ("trot", 1.8)]
    others = ["run=scratch", "env.foot_stance=false", "motion.labels=gait", "motion.frequencies_hz=[1.8]"]
    same = clips_for(folder, "motion.skills=[trot]", *others)
    assert same == [("trot", 1.57), ("trot", 1.82), ("trot", 1.8)]


@pytest.mark.parametrize("labels", ["gait", "gait_frequency"])
@pytest.mark.parametrize("wanted", [[2.0, 3.0], [4.0], [2.0, 3.0, 4.0]])
def test_frequencies_select_clips_under_every_label(labels: str, wanted: list[float]) -> None:
    config = compose_config(["motion.skills=[pronk]", f"motion.labels={labels}", f"motion.frequencies_hz={wanted}"])
    clips = expert_clips(config)
    assert sorted({clip.frequency_hz for clip in clips}) == wanted
    skills = config.motion.skill_set()
    assert {label_of(clip.gait, clip.frequency_hz, skills) for clip in clips} == set(range(len(skills)))


# Gaits and frequencies of a folder; what is asked for; what the message names.
CASES = [
    ([("trot", 1.57), ("trot", 1.82), ("trot", 2.15)], [], "trot at 1.57, 1.82, 2.15 Hz"),
    ([("trot", 1.57)], ["motion.labels=gait"], "trot at 1.57 Hz"),
    ([("trot", 1.57), ("pace", 3.9)], [], "trot at 1.57 Hz"),
    ([("trot", 2.0), ("pace", 2.1), ("pace", 3.1)], [], "pace at 2.1, 3.1 Hz"),
    ([("bound", 6.0), ("bound", 5.9)], ["motion.skills=[trot]"], "bound at 5.9, 6 Hz"),
    ([("trot", 3.42), ("trot", 3.38)], ["motion.labels=gait_frequency", "motion.frequencies_hz=[3,4]"], "3.38, 3.42"),
    ([("trot", 2.0), ("trot", 2.0)], ["motion.labels=gait", "motion.frequencies_hz=[4]"], "trot at 2 Hz"),
]


@pytest.mark.parametrize(("found", "asked", "named"), CASES)
def test_the_message_names_what_is_there_and_what_would_load(
    tmp_path: Path, found: list[tuple[str, float]], asked: list[str], named: str
) -> None:
    folder = folder_of(tmp_path, found)
    with pytest.raises(ClipError) as caught:
        clips_for(folder, *asked)
    message = str(caught.value)
    assert named in message and str(folder) in message and "within 15%" in message and "\n" not in message
    advised = message.rpartition("train with ")[2].split()
    assert all(re.fullmatch(r"run=scratch|env.foot_stance=false|motion\.\w+=\S+", override) for override in advised)
    assert clips_for(folder, *advised)


def test_a_folder_of_other_clips_alone(tmp_path: Path) -> None:
    save_clip(tmp_path / "stand.npz", load_clip(FOLDER / "stand_low.npz"))
    with pytest.raises(ClipError, match=r"no clip in .* is for training \(steady, varied, recovery\)"):
        clips_for(tmp_path)


def test_the_documented_command_trains_on_imported_clips(tmp_path: Path) -> None:
    root = repository_root()
    assert root is not None
    text = (root / "docs" / "motions.md").read_text(encoding="utf-8")
    command = text[text.index("python -m camp.train run=scratch") :].partition("\n\n")[0].replace("\\\n", " ")
    overrides = command.split()[3:]
    found = [("trot", 1.82), ("trot", 2.15), ("pace", 1.57), ("trot", 3.0)]
    folder = folder_of(tmp_path, found)
    assert clips_for(folder, *(o for o in overrides if not o.startswith("motion.folder="))) == found[:3]


@pytest.mark.parametrize("frequencies", ["[1.8]", "[2,2.5]"])
def test_what_no_expert_walks_cannot_be_imitated(frequencies: str) -> None:
    with pytest.raises(ConfigError, match=r"frequencies_hz.*walks at 2, 3, 4 Hz.*within 15% are taken.*run=scratch"):
        compose_config([f"motion.frequencies_hz={frequencies}"])
    compose_config(["run=scratch", f"motion.frequencies_hz={frequencies}"])


@pytest.mark.parametrize("frequencies", ["[inf]", "[nan]", "[0]", "[-2]", "[1e9]", "[]"])
def test_frequencies_have_a_range(frequencies: str) -> None:
    with pytest.raises(ConfigError, match=r"motion.frequencies_hz.*(from 0.1 to 12.5 \(Hz|list stride frequencies)"):
        compose_config(["run=scratch", f"motion.frequencies_hz={frequencies}"])
