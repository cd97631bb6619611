"""What is wrong with a file of another project is named, with its value and the remedy; the remedies work."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camp.common.errors import ClipError
from camp.motion.clips.clip import Clip
from camp.motion.exchange.convert import import_motion
from camp.motion.exchange.exporter import export_amp
from camp.motion.exchange.feet import foot_heights
from camp.motion.exchange.motion import ImportOptions
from camp.robots.go2 import GO2
from tests.motion.exchange.foreign import TROT, edit, in_world, qpos_of, shipped, spoiled, swap_legs, write_qpos


@pytest.fixture
def amp(tmp_path: Path) -> Path:
    export_amp(tmp_path / "trot.txt", shipped())
    return tmp_path / "trot.txt"


def test_kine2go_knows_its_own_layout(tmp_path: Path, amp: Path) -> None:
    frames = np.array(json.loads(amp.read_text())["Frames"])
    np.save(tmp_path / "motion.npy", frames)  # 61 columns, but those of the text format
    with pytest.raises(ClipError, match=r"columns 0\.\.2 and 48\.\.50 both hold the base position"):
        import_motion(tmp_path / "motion.npy", "kine2go", TROT)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"FrameDuration": 0}, "'FrameDuration' is '0', expected seconds, more than 0; pass --rate"),
        ({"FrameDuration": "fast"}, "'FrameDuration' is 'fast'"),
        ({"FrameDuration": 20.0}, "frame rate is 0.05 Hz, expected 10 to 1000; pass --rate HZ"),
        ({"FrameDuration": 0.04}, "at 25 Hz the joints move 0.52 times and the root moves 0.50 times"),
        ({"FrameDuration": 0.016}, "the motion was sampled at about 50 Hz: pass --rate 50"),
        ({"Frames": lambda frames: frames[:2]}, "Frames holds 2 frames, at least 4"),
        ({"Frames": lambda frames: frames[:, :60]}, "frame 0 of 'Frames' has 60 numbers, expected 61"),
        ({"Frames": [[0.0] * 61, [0.0] * 60]}, "frame 1 of 'Frames' has 60 numbers, expected 61"),
        ({"Frames": 3}, "'Frames' is no list of lists"),
        ({"Frames": [["a"] * 61] * 4}, "holds something that is no number"),
        ({"Frames": spoiled(slice(40, 41), np.nan, slice(5, 6))}, "Frames holds nan in frame 5, column 40"),
        ({"Frames": spoiled(slice(3, 7), 1.2, slice(9, 10))}, "quaternion of frame 9 has norm 1.200"),
        (
            {"Frames": lambda f: np.concatenate([f[:, :3], f[:, [6, 3, 4, 5]], f[:, 7:]], axis=1)},
            "in the order wxyz it is upright: pass --quaternion-order wxyz",
        ),
        ({"Frames": swap_legs}, "pass --leg-order FL,FR,RL,RR"),
        ({"Frames": spoiled(slice(19, 31), 1.15)}, "if the file was made for another robot, pass --trust-joints"),
        ({"Frames": in_world}, "pass --velocity-frame world"),
        ({"Frames": spoiled(slice(34, 37), 5.0)}, "root angular velocity misses the change of the positions"),
        ({"Frames": spoiled(slice(7, 19), 57.3)}, "m (mean) from those of a Unitree Go2"),
        ({"Frames": spoiled(slice(2, 3), 1.5)}, "from the floor (z = 0), at most 0.03 m is allowed; pass --ground"),
    ],
)
def test_what_is_wrong_with_a_text_file_is_named(amp: Path, change: dict, reason: str) -> None:
    with pytest.raises(ClipError) as caught:
        import_motion(edit(amp, **change), "amp", TROT)
    message = str(caught.value)
    assert reason in message
    assert str(amp) in message
    assert "\n" not in message


def test_remedies_work(amp: Path) -> None:
    """The options that the messages name do what they promise."""
    clip = shipped()
    content = amp.read_text()

    def imported(change: dict, **options: object) -> Clip:
        amp.write_text(content)
        return import_motion(edit(amp, **change), "amp", replace(TROT, **options))  # pyright: ignore[reportArgumentType]

    legs = imported({"Frames": swap_legs}, leg_order=("FL", "FR", "RL", "RR"))
    np.testing.assert_array_equal(legs.joint_position, clip.joint_position)
    trusted = imported({"Frames": spoiled(slice(19, 31), 1.15)}, trust_joints=True)
    np.testing.assert_allclose(trusted.foot_position, clip.foot_position, atol=2e-6)
    turned = imported({"Frames": in_world}, velocity_frames=("world", "world"))
    np.testing.assert_allclose(turned.base_linear_velocity, clip.base_linear_velocity, atol=1e-5)
    np.testing.assert_allclose(turned.base_angular_velocity, clip.base_angular_velocity, atol=1e-5)
    raised = imported({"Frames": spoiled(slice(2, 3), 1.5)}, ground=True)
    heights = foot_heights(raised.base_position, raised.base_quaternion, raised.foot_position)
    assert abs(np.percentile(heights, 5) - 0.022) < 0.005
    derived = imported({"Frames": spoiled(slice(34, 37), 5.0)}, derive_velocities=True)
    mismatch = derived.base_angular_velocity - clip.base_angular_velocity
    assert np.sqrt(np.mean(mismatch**2)) < 0.3
    at_rate = imported({"FrameDuration": 0.04}, rate_hz=50.0)
    np.testing.assert_array_equal(at_rate.joint_position, clip.joint_position)
    with pytest.raises(ClipError, match="joints read as FL,FR,RL,RR"):  # trust is not blindness
        imported({}, leg_order=("FL", "FR", "RL", "RR"), trust_joints=True)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda table: table[:, :18], "shape (200, 18), expected (frames, 19); pass another --format"),
        (lambda table: table[:2], "holds 2 frames, at least 4 are needed"),
        (lambda table: table[0], "shape (19,)"),
        (lambda table: table.astype("U9"), "dtype <U9, expected numbers"),
        (lambda table: table[:, [0, 1, 2, 4, 5, 6, 3, *range(7, 19)]], "read as wxyz, lets standing feet slip at"),
        (
            lambda table: table[:, [*range(7), 8, 7, 9, *range(10, 19)]][:, [*range(7), *range(18, 6, -1)]],
            "rad in frame",
        ),
        (lambda table: np.where(np.arange(19) > 6, np.degrees(table), table), "angles must be in rad"),
        (
            lambda table: np.where(np.arange(19) == 12, np.inf, table),
            "holds inf in frame 0, column 12 (200 such values), expected numbers up to 1e+06",
        ),
    ],
)
def test_what_is_wrong_with_qpos_is_named(tmp_path: Path, change, reason: str) -> None:
    path = write_qpos(tmp_path / "m.npy", change(qpos_of(shipped())))
    with pytest.raises(ClipError) as caught:
        import_motion(path, "qpos", replace(TROT, rate_hz=50.0))
    assert reason in str(caught.value)
    assert str(path) in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    at_50 = replace(TROT, rate_hz=50.0)
    with pytest.raises(ClipError, match="does not exist"):
        import_motion(tmp_path / "none.txt", "amp", TROT)
    path = tmp_path / "m.npy"
    np.save(path, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(ClipError, match=r"cannot be read as \.npy \(.*Python objects"):
        import_motion(path, "qpos", at_50)
    path.write_bytes(write_qpos(path, qpos_of(shipped())).read_bytes()[:300])
    with pytest.raises(ClipError, match=r"cannot be read as \.npy"):
        import_motion(path, "kine2go", TROT)
    text = tmp_path / "m.csv"
    for content, reason in (("1,2\n1,2,3\n", "row 1 has 3 numbers"), ("1,2\n1,x\n", "row 1 holds 'x'"), ("", "shape")):
        text.write_text(content)
        with pytest.raises(ClipError, match=reason):
            import_motion(text, "qpos", at_50)
    text.write_text("{")
    with pytest.raises(ClipError, match="cannot be read as JSON"):
        import_motion(text, "amp", TROT)
    text.write_text('{"Frames": []}')
    with pytest.raises(ClipError, match="key 'FrameDuration' is missing"):
        import_motion(text, "amp", TROT)
    text.write_text("[]")
    with pytest.raises(ClipError, match="holds a JSON list"):
        import_motion(text, "amp", TROT)


def test_what_is_asked_for_must_make_sense(amp: Path, tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="--gait 'gallop': pass one of trot"):
        import_motion(amp, "amp", ImportOptions(GO2, gait="gallop"))
    with pytest.raises(ClipError, match="format 'bvh': pass one of amp, qpos, kine2go"):
        import_motion(amp, "bvh", TROT)
    path = write_qpos(tmp_path / "m.npy", qpos_of(shipped()))
    with pytest.raises(ClipError, match="does not carry its frame rate; pass --rate HZ"):
        import_motion(path, "qpos", TROT)
    standing = np.tile(qpos_of(shipped())[:1], (100, 1))
    with pytest.raises(ClipError, match=r"no stride frequency can be measured.*pass --frequency HZ"):
        import_motion(write_qpos(path, standing), "qpos", replace(TROT, rate_hz=50.0, ground=True))
