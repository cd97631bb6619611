"""The clip format: what is written comes back, what is broken is refused with its reason."""

from __future__ import annotations

import multiprocessing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from camp.common.errors import ClipError
from camp.motion.clips.clip import Clip, amp_state
from camp.motion.clips.mirror import mirrored
from camp.motion.clips.store import load_clip, load_clips, save_clip
from camp.robots import kinematics
from camp.robots.a1 import A1
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES

STEPS = 6


def make_clip(gait: str = "trot", varying: bool = False) -> Clip:
    rng = np.random.default_rng(0)

    def rows(*shape: int) -> np.ndarray:
        return rng.standard_normal((STEPS, *shape)).astype(np.float32)

    quaternion = rows(4)
    return Clip(
        dt=0.02,
        gait=gait,
        frequency_hz=2.0,
        command=rows(3) if varying else np.array([0.5, 0.0, 0.1], dtype=np.float32),
        base_position=rows(3),
        base_quaternion=quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True),
        joint_position=rows(12),
        joint_velocity=rows(12),
        base_linear_velocity=rows(3),
        base_angular_velocity=rows(3),
        foot_position=rows(4, 3),
        foot_velocity=rows(4, 3),
        foot_contact=rows(4) > 0,
        joint_target=rows(12),
        joint_target_applied=rows(12),
        joint_torque=rows(12),
    )


def still_clip(gait: str = "trot", split: str = "steady") -> Clip:
    """A clip that agrees with itself: the robot stands in its default pose."""
    pose = np.tile(np.array(GO2.default_joint_position, dtype=np.float32), (STEPS, 1))
    feet = kinematics.foot_position(GO2.leg, torch.from_numpy(pose)).numpy()

    def rows(*values: float) -> np.ndarray:
        return np.tile(np.array(values, dtype=np.float32), (STEPS, 1))

    return replace(
        make_clip(gait),
        split=split,
        base_position=rows(0, 0, GO2.standing_height),
        base_quaternion=rows(1, 0, 0, 0),
        joint_position=pose,
        joint_velocity=rows(*[0.0] * 12),
        base_linear_velocity=rows(0, 0, 0),
        base_angular_velocity=rows(0, 0, 0),
        foot_position=feet,
        foot_velocity=np.zeros_like(feet),
    )


def rewrite(path: Path, **changes: np.ndarray | None) -> None:
    """Replace keys of a clip file, or remove those given as None."""
    with np.load(path) as archive:
        arrays = dict(archive)
    arrays |= {name: value for name, value in changes.items() if value is not None}
    np.savez_compressed(path, **{name: value for name, value in arrays.items() if changes.get(name, 1) is not None})


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "clip.npz"
    save_clip(path, make_clip())
    return path


@pytest.mark.parametrize("varying", [False, True])
def test_round_trip(tmp_path: Path, varying: bool) -> None:
    clip = make_clip(varying=varying)
    save_clip(tmp_path / "new" / "clip.npz", clip)
    loaded = load_clip(tmp_path / "new" / "clip.npz")
    for name, value in vars(clip).items():
        np.testing.assert_array_equal(getattr(loaded, name), value)
        if isinstance(value, np.ndarray):
            assert getattr(loaded, name).dtype == value.dtype
    assert (loaded.joint_names, loaded.foot_names) == (JOINT_NAMES, FOOT_NAMES)
    assert loaded.is_steady == loaded.holds_command != varying
    assert not replace(loaded, split="varied").is_steady
    assert len(loaded) == STEPS
    assert [file.name for file in (tmp_path / "new").iterdir()] == ["clip.npz"]  # nothing half-written stays


def test_every_number_on_disk_is_single_precision(path: Path) -> None:
    with np.load(path) as archive:
        kinds = {name: archive[name].dtype for name in archive.files}
    texts = {"gait", "joint_names", "foot_names", "split", "previous_gait", "source"}
    others = {*texts, "foot_contact", "seed", "switch_step"}
    assert {str(kind) for name, kind in kinds.items() if name not in others} == {"float32"}
    assert kinds["foot_contact"].kind == "b"


def bad(value: float, *shape: int) -> np.ndarray:
    return np.full(shape, value, dtype=np.float32)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"joint_target": None}, "key 'joint_target' is missing"),
        ({"base_position": bad(np.nan, STEPS, 3)}, "'base_position' holds values that are not finite"),
        ({"dt": bad(np.inf)}, "'dt' holds values that are not finite"),
        ({"foot_position": bad(0.0, STEPS, 12)}, "'foot_position' has shape (6, 12), expected (6, 4, 3)"),
        ({"joint_velocity": bad(0.0, STEPS - 1, 12)}, "'joint_velocity' has shape (5, 12)"),
        ({"joint_position": bad(0.0, 1, 12)}, "at least 2 are needed"),
        ({"joint_position": bad(0.0)}, "at least 2 are needed"),
        ({"command": bad(0.0, 2)}, "'command' has shape (2,)"),
        ({"foot_contact": bad(1.0, STEPS, 4)}, "'foot_contact' has dtype float32"),
        ({"base_quaternion": bad(1.0, STEPS, 4)}, "'base_quaternion' has norms from 2.000"),
        ({"joint_names": np.array(JOINT_NAMES[::-1])}, "'joint_names' is ['RR_calf_joint'"),
        ({"foot_names": np.array(["FR", "FL", "RR", "RL"])}, "expected ['FL', 'FR', 'RL', 'RR']"),
        ({"gait": np.array("gallop")}, "'gait' is 'gallop'"),
        ({"frequency_hz": bad(0.0)}, "'frequency_hz' is 0, expected 0.1 to 12.5"),
        ({"frequency_hz": bad(-2.0)}, "'frequency_hz' is -2"),
        ({"frequency_hz": bad(1e9)}, "'frequency_hz' is 1e+09"),
        ({"frequency_hz": bad(2.0, 3)}, "'frequency_hz' has shape (3,)"),
        ({"dt": bad(1e30)}, "'dt' is 1"),
        ({"split": np.array("odd")}, "'split' is 'odd'"),
        ({"gait": np.array("stand")}, "'gait' is 'stand' and 'split' 'steady'"),
        ({"switch_step": np.int64(STEPS)}, "'switch_step' is 6, expected a row, 0 to 5"),
        ({"seed": bad(1.0)}, "'seed' has dtype float32"),
        (
            {"joint_target": np.array([[None]], dtype=object)},
            "cannot be read (Object arrays cannot be loaded",
        ),
    ],
)
def test_broken_content_is_named(path: Path, change: dict, reason: str) -> None:
    rewrite(path, **change)
    with pytest.raises(ClipError) as caught:
        load_clip(path)
    message = str(caught.value)
    assert reason in message
    assert str(path) in message
    assert "python -m camp.dataset" in message
    assert "\n" not in message


@pytest.mark.parametrize("keep", [0, 10, 1000, -30])
def test_truncated_file(path: Path, keep: int) -> None:
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(ClipError, match="cannot be read"):
        load_clip(path)


def test_file_of_another_kind(path: Path) -> None:
    with path.open("wb") as file:
        np.save(file, np.zeros(3))
    with pytest.raises(ClipError, match="cannot be read"):
        load_clip(path)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="does not exist"):
        load_clip(tmp_path / "none.npz")


@pytest.mark.parametrize(("varying", "split"), [(False, "steady"), (True, "perturbed")])
def test_older_files_are_read(tmp_path: Path, varying: bool, split: str) -> None:
    path = tmp_path / "clip.npz"
    save_clip(path, make_clip(varying=varying))
    rewrite(path, split=None, seed=None, previous_gait=None, switch_step=None, source=None)
    clip = load_clip(path)
    assert (clip.split, clip.seed, clip.previous_gait, clip.switch_step) == (split, 0, "", 0)


def test_standing_has_no_stride(path: Path) -> None:
    stand = replace(make_clip("stand"), split="stand", frequency_hz=0.0)
    save_clip(path, stand)
    assert load_clip(path).frequency_hz == 0.0
    with pytest.raises(ClipError, match=r"not written.*or 0 for standing"):
        save_clip(path, replace(stand, frequency_hz=2.0))
    assert load_clip(path).frequency_hz == 0.0  # what was there stays
    rewrite(path, frequency_hz=bad(2.0))
    with pytest.raises(ClipError, match="or 0 for standing"):
        load_clip(path)


@pytest.mark.parametrize(
    "change",
    [
        {"command": np.float32([0.6, 0.0, np.nan])},
        {"frequency_hz": float("inf")},
        {"frequency_hz": -2.0},
        {"base_quaternion": np.zeros((STEPS, 4), dtype=np.float32)},
        {"joint_target": np.zeros((STEPS, 11), dtype=np.float32)},
        {"gait": "gallop"},
    ],
)
def test_what_could_not_be_loaded_is_not_written(path: Path, change: dict) -> None:
    good = path.read_bytes()
    with pytest.raises(ClipError, match="not written, for it could not be loaded"):
        save_clip(path, replace(make_clip(), **change))
    assert path.read_bytes() == good
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_a_folder_that_takes_no_clip_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ClipError, match=r"clip .*clip\.npz: cannot be written \(.*another folder"):
        save_clip(tmp_path / "file" / "clip.npz", make_clip())


def test_frequencies_survive_single_precision(path: Path) -> None:
    save_clip(path, replace(make_clip(), frequency_hz=1.8))
    assert load_clip(path).frequency_hz == 1.8


def _save_often(path: Path) -> None:
    for _ in range(15):
        save_clip(path, make_clip())


def test_two_that_write_one_clip_do_not_tear_it(path: Path) -> None:
    writers = [multiprocessing.get_context("fork").Process(target=_save_often, args=(path,)) for _ in range(2)]
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        assert len(load_clip(path)) == STEPS
    for writer in writers:
        writer.join()
        assert writer.exitcode == 0
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_folder_keeps_the_skills_asked_for(tmp_path: Path) -> None:
    for name, gait in (("b", "trot"), ("a", "pace"), ("c", "bound")):
        save_clip(tmp_path / f"{name}.npz", still_clip(gait))
    assert [clip.gait for clip in load_clips(GO2, tmp_path, ["trot", "pace"])] == ["pace", "trot"]


def test_folder_keeps_the_splits_asked_for(tmp_path: Path) -> None:
    splits = ("steady", "varied", "recovery", "transition", "perturbed")
    for index, split in enumerate(splits):
        save_clip(tmp_path / f"{index}.npz", still_clip(split=split))
    save_clip(tmp_path / "5.npz", replace(still_clip("stand", "stand"), frequency_hz=0.0))
    assert [clip.split for clip in load_clips(GO2, tmp_path, ["trot"])] == ["steady", "varied", "recovery"]
    assert [clip.split for clip in load_clips(GO2, tmp_path, ["trot"], ["transition"])] == ["transition"]
    assert [clip.gait for clip in load_clips(GO2, tmp_path, ["stand"], ["stand"])] == ["stand"]
    with pytest.raises(ClipError, match=r"skill 'stand' has no clip .*found: trot\)"):
        load_clips(GO2, tmp_path, ["stand"])
    with pytest.raises(ClipError, match="split 'steedy' is unknown; choose from steady"):
        load_clips(GO2, tmp_path, ["trot"], ["steedy"])


def test_folder_gives_mirror_images(tmp_path: Path) -> None:
    save_clip(tmp_path / "clip.npz", still_clip())
    clip, image = load_clips(GO2, tmp_path, ["trot"], with_mirrored=True)
    np.testing.assert_array_equal(image.foot_contact, mirrored(clip).foot_contact)


def test_loading_refuses_what_does_not_move_as_it_says(tmp_path: Path) -> None:
    clip = still_clip()
    save_clip(tmp_path / "clip.npz", replace(clip, foot_position=clip.foot_position[:, [1, 0, 3, 2]]))
    with pytest.raises(ClipError, match=r"clip.npz: foot off its leg \(m\) .* camp.dataset validate"):
        load_clips(GO2, tmp_path, ["trot"])


def test_skill_without_clips(tmp_path: Path) -> None:
    save_clip(tmp_path / "clip.npz", still_clip())
    with pytest.raises(ClipError, match=r"skill 'pronk' has no clip .*found: trot.*python -m camp\.dataset"):
        load_clips(GO2, tmp_path, ["trot", "pronk"])


@pytest.mark.parametrize("folder", ["missing", "."])
def test_folder_without_clips(tmp_path: Path, folder: str) -> None:
    with pytest.raises(ClipError, match=r"no clips in .*; generate them with `python -m camp\.dataset --robot a1 "):
        load_clips(A1, tmp_path / folder, ["trot"])


def test_amp_state_is_in_the_papers_order() -> None:
    clip = make_clip()
    state = amp_state(clip)
    assert state.shape == (STEPS, 43)
    assert state.dtype == np.float32
    expected = [
        *clip.joint_position[2],
        *clip.joint_velocity[2],
        *clip.base_linear_velocity[2],
        *clip.base_angular_velocity[2],
        clip.base_position[2, 2],
        *clip.foot_position[2].reshape(-1),
    ]
    np.testing.assert_array_equal(state[2], expected)
