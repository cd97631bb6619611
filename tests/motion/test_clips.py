"""The clip format: what is written comes back, what is broken is refused with its reason."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from camp.errors import ClipError
from camp.motion.clips import Clip, amp_state, load_clip, load_clips, save_clip
from camp.robots.go2 import FOOT_NAMES, JOINT_NAMES

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
    assert loaded.is_steady != varying
    assert len(loaded) == STEPS
    assert [file.name for file in (tmp_path / "new").iterdir()] == ["clip.npz"]  # nothing half-written stays


def test_every_number_on_disk_is_single_precision(path: Path) -> None:
    with np.load(path) as archive:
        kinds = {name: archive[name].dtype for name in archive.files}
    others = {"gait", "joint_names", "foot_names", "foot_contact"}
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
        ({"frequency_hz": bad(0.0)}, "'frequency_hz' is 0.0"),
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


def test_folder_keeps_the_skills_asked_for(tmp_path: Path) -> None:
    for name, gait in (("b", "trot"), ("a", "pace"), ("c", "bound")):
        save_clip(tmp_path / f"{name}.npz", make_clip(gait))
    assert [clip.gait for clip in load_clips(tmp_path, ["trot", "pace"])] == ["pace", "trot"]


def test_skill_without_clips(tmp_path: Path) -> None:
    save_clip(tmp_path / "clip.npz", make_clip())
    with pytest.raises(ClipError, match=r"skill 'pronk' has no clip .*found: trot.*python -m camp\.dataset"):
        load_clips(tmp_path, ["trot", "pronk"])


@pytest.mark.parametrize("folder", ["missing", "."])
def test_folder_without_clips(tmp_path: Path, folder: str) -> None:
    with pytest.raises(ClipError, match="no clips in"):
        load_clips(tmp_path / folder, ["trot"])


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
