"""Files as others write them, on the command line: read right, or refused in one line whose remedy can be pasted."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest

from camp.common.errors import ClipError
from camp.dataset import main
from camp.motion.clips.store import load_clip
from camp.motion.exchange.checks import check_quaternion_order
from camp.motion.exchange.exporter import export_amp
from camp.motion.exchange.feet import check_feet, feet_of
from camp.motion.exchange.motion import Motion, by_leg
from camp.motion.exchange.rotations import continuous, multiply, rotate
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from tests.errors import assert_one_line
from tests.motion.exchange.foreign import FOLDER, HALF_TURN, qpos_of, shipped

Change = Callable[[np.ndarray], np.ndarray]
JOINTS, FEET = (7, 37), (19, 49)  # first columns of positions and of velocities
LINEAR, ANGULAR = slice(31, 34), slice(34, 37)
# Options after "pass", with what belongs to them; the last ones of a message are the remedy.
REMEDY = re.compile(r"pass ((?:--[a-z-]+(?: (?:[A-Z]{2}(?:,[A-Z]{2})+|[\d.]+|wxyz|xyzw|(?:world|base)(?:,\w+)?))? ?)+)")


def exported(path: Path, change: Change, **others: object) -> Path:
    """The shipped trot in the text format, its frames changed."""
    export_amp(path, shipped())
    content = json.loads(path.read_text())
    content["Frames"] = change(np.array(content["Frames"])).tolist()
    path.write_text(json.dumps(content | others))
    return path


def legs(order: list[int], *starts: int) -> Change:
    def change(frames: np.ndarray) -> np.ndarray:
        for start in starts:
            block = frames[:, start : start + 12].reshape(-1, 4, 3)[:, order]
            frames[:, start : start + 12] = block.reshape(-1, 12)
        return frames

    return change


def facing_backward(*in_world: slice) -> Change:
    """Turned by half a turn, the given root velocities in the world frame."""

    def change(frames: np.ndarray) -> np.ndarray:
        quaternion = multiply(np.broadcast_to(HALF_TURN, (len(frames), 4)), frames[:, [6, 3, 4, 5]])
        frames[:, 3:7] = quaternion[:, [1, 2, 3, 0]]
        frames[:, :2] *= -1.0
        for columns in in_world:
            frames[:, columns] = rotate(quaternion, frames[:, columns])
        return frames

    return change


def times(factor: float, first: int, last: int) -> Change:
    def change(frames: np.ndarray) -> np.ndarray:
        frames[:, first:last] *= factor
        return frames

    return change


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    code = main([str(argument) for argument in arguments])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def imported(path: Path, capsys: pytest.CaptureFixture[str], *options: str) -> tuple[int, str, Path]:
    """Code, what was said on either stream, and the clip's path."""
    folder = path.parent / "clips"
    reading = ["import", path, "--gait", "trot", "--folder", folder, "--name", "clip", *options]
    code, out, err = run(capsys, *reading, *([] if "--format" in options else ["--format", "amp"]))
    return code, out + err, folder / "clip.npz"


# What is changed, and the remedies that are asked for, in turn; none where the file is read as it is.
AMP_CASES: dict[str, tuple[Change, dict, tuple[str, ...]]] = {
    "as exported": (lambda f: f, {}, ()),
    "19 numbers": (lambda f: f[:, :19], {}, ()),
    "19 numbers, w first": (
        lambda f: f[:, [0, 1, 2, 6, 3, 4, 5, *range(7, 19)]],
        {},
        ("--quaternion-order wxyz",),
    ),
    "no velocities, no feet": (times(0.0, 19, 61), {}, ()),
    "left legs of the joints first": (
        legs([1, 0, 3, 2], *JOINTS),
        {},
        ("--leg-order FL,FR,RL,RR --foot-order FR,FL,RR,RL",),
    ),
    "left legs of the feet first": (
        legs([1, 0, 3, 2], *FEET),
        {},
        ("--leg-order FR,FL,RR,RL --foot-order FL,FR,RL,RR",),
    ),
    "left legs first": (legs([1, 0, 3, 2], *JOINTS, *FEET), {}, ("--leg-order FL,FR,RL,RR",)),
    "rear legs of the joints first": (
        legs([2, 3, 0, 1], *JOINTS),
        {},
        ("--leg-order RR,RL,FR,FL --foot-order FR,FL,RR,RL",),
    ),
    "facing backward": (facing_backward(), {}, ()),
    "velocities in the world": (facing_backward(LINEAR, ANGULAR), {}, ("--velocity-frame world",)),
    "MuJoCo's velocities": (facing_backward(LINEAR), {}, ("--velocity-frame world,base",)),
    "angular velocity in the world": (facing_backward(ANGULAR), {}, ("--velocity-frame base,world",)),
    "joint velocities too fast": (times(1.25, 37, 49), {}, ("--derive-velocities",)),
    "root velocity too fast": (times(1.3, 31, 34), {}, ("--derive-velocities",)),
    "half the rate": (lambda f: f, {"FrameDuration": 0.04}, ("--rate 50",)),
    "too high a rate": (lambda f: f, {"FrameDuration": 0.008}, ("--rate 50",)),
    "a rate of nothing": (lambda f: f, {"FrameDuration": None}, ("--rate",)),
    "two mistakes": (
        lambda f: legs([1, 0, 3, 2], *JOINTS)(facing_backward(LINEAR)(f)),
        {},
        ("--leg-order FL,FR,RL,RR --foot-order FR,FL,RR,RL", "--velocity-frame world,base"),
    ),
    "above the floor": (lambda f: f + np.eye(61)[2], {}, ("--ground",)),
}


@pytest.mark.parametrize("name", AMP_CASES)
def test_text_files_are_read_right_once_the_remedies_are_pasted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    change, others, remedies = AMP_CASES[name]
    path = exported(tmp_path / "motion.txt", change, **others)
    options: list[str] = []
    for remedy in remedies:
        code, said, clip = imported(path, capsys, *options)
        assert code == 2 and not clip.exists()
        assert_one_line(said)
        found = REMEDY.findall(said)
        assert found and found[-1].strip() == remedy, said
        options += shlex.split(remedy if remedy != "--rate" else "--rate 50")
    code, said, clip = imported(path, capsys, *options)
    assert code == 0, said
    true, back = shipped(), load_clip(clip)
    np.testing.assert_allclose(back.joint_position, true.joint_position, atol=1e-6)
    assert np.sqrt(np.mean((back.base_linear_velocity - true.base_linear_velocity) ** 2)) < 0.03
    assert np.sqrt(np.mean((back.joint_velocity - true.joint_velocity) ** 2)) < 0.5
    assert back.frequency_hz == pytest.approx(2.0, rel=0.01)


def text_with(place: str, text: str) -> Callable[[str], str]:
    return lambda content: content.replace(place, text, 1)


@pytest.mark.parametrize(
    ("edit", "reason"),
    [
        (text_with("[[", "[[NaN, "), "frame 0 of 'Frames' has 62 numbers, expected 61 or 19"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[NaN", t), "holds nan in frame 0, column 0"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[1e999", t), "holds inf in frame 0, column 0"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[1e30", t), "holds 1e+30 in frame 0, column 0"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[1" + "0" * 400, t), "whole number beyond all floats"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[1" + "0" * 5000, t), "cannot be read as JSON"),
        (lambda t: re.sub(r"\[\[[^,]+", '[["0.1"', t), "something that is no number ('0.1')"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[true", t), "something that is no number ('True')"),
        (lambda t: re.sub(r"\[\[[^,]+", "[[null", t), "something that is no number ('None')"),
        (lambda t: '{"FrameDuration": 0.02, "Frames": ' + "[" * 100_000, "cannot be read as JSON"),
        (lambda t: '{"FrameDuration": 0.02, "Frames": []}', "'Frames' is no list of lists"),
        (lambda t: t[: len(t) // 2], "cannot be read as JSON"),
        (lambda t: "", "cannot be read as JSON"),
        (lambda t: json.dumps({"frames": 1, "fps": 50}), "key 'FrameDuration' is missing (found: frames, fps)"),
        (lambda t: t.replace('"FrameDuration": 0.02', '"FrameDuration": -0.02'), "pass --rate HZ"),
        (lambda t: t.replace('"FrameDuration": 0.02', '"FrameDuration": 1e-9'), "pass --rate HZ"),
        (lambda t: t.replace('"FrameDuration": 0.02', f'"FrameDuration": 1{"0" * 400}'), "pass --rate HZ"),
    ],
)
def test_broken_text_files_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], edit: Callable[[str], str], reason: str
) -> None:
    path = exported(tmp_path / "motion.txt", lambda frames: frames)
    path.write_text(edit(path.read_text()))
    code, said, clip = imported(path, capsys)
    assert code == 2 and not clip.exists()
    assert_one_line(said, reason)
    assert len(said) < 1000


def test_json_with_a_byte_order_mark(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = exported(tmp_path / "motion.txt", lambda frames: frames)
    path.write_text(path.read_text(), encoding="utf-8-sig")
    assert imported(path, capsys)[0] == 0


def test_other_widths_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = exported(tmp_path / "motion.txt", lambda frames: frames[:, :49])
    assert_one_line(imported(path, capsys)[1], "frame 0 of 'Frames' has 49 numbers, expected 61 or 19")


@pytest.mark.parametrize(
    ("separator", "decimal", "head", "encoding"),
    [
        (",", ".", "", "utf-8"),
        (";", ".", "", "utf-8"),
        (";", ",", "", "utf-8-sig"),
        ("\t", ".", "", "utf-8"),
        (" ", ".", "", "utf-8"),
        ("  ", ".", "", "utf-8"),
        (",", ".", "names", "utf-8"),
        (";", ",", "names", "utf-8-sig"),
        (" ", ".", "# names", "utf-8"),
    ],
)
def test_tables_of_every_separator(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], separator: str, decimal: str, head: str, encoding: str
) -> None:
    names = ["x", "y", "z", "qw", "qx", "qy", "qz", *JOINT_NAMES]
    lines = [separator.join(f"{value:.9g}".replace(".", decimal) for value in row) for row in qpos_of(shipped())]
    if head:
        lines.insert(0, head.replace("names", separator.join(names)))
    path = tmp_path / "walk.csv"
    path.write_text("\r\n".join(lines) + f"{separator}\r\n\r\n", encoding=encoding)
    code, said, clip = imported(path, capsys, "--format", "qpos", "--rate", "50")
    assert code == 0, said
    np.testing.assert_allclose(load_clip(clip).joint_position, shipped().joint_position, atol=1e-6)


@pytest.mark.parametrize(
    "name", ["trot_2hz_in_place", "pronk_3hz_in_place", "pronk_2hz_forward_0.6", "trot_4hz_in_place"]
)
@pytest.mark.parametrize("w_first", [False, True])
def test_the_order_of_a_quaternion_is_told(tmp_path: Path, name: str, w_first: bool) -> None:
    """Also in place, where a body that faces backward would look the same from above."""
    clip = load_clip(FOLDER / f"{name}.npz")
    quaternion = clip.base_quaternion.astype(np.float64)
    read = continuous(quaternion if w_first else quaternion[:, [1, 2, 3, 0]])
    position, joints = clip.base_position.astype(np.float64), clip.joint_position.astype(np.float64)
    motion = Motion(50.0, position, read, joints, quaternion_order="wxyz")
    if w_first:
        check_quaternion_order(GO2, motion)
    else:
        with pytest.raises(ClipError, match="pass --quaternion-order xyzw"):
            check_quaternion_order(GO2, motion)


def npy(path: Path, array: np.ndarray) -> Path:
    np.save(path, array, allow_pickle=True)
    return path


@pytest.mark.parametrize(
    ("array", "reason"),
    [
        (np.zeros((10, 19), dtype=complex), "dtype complex128, expected numbers"),
        (np.zeros((10, 19), dtype=bool), "dtype bool, expected numbers"),
        (np.zeros((10, 19), dtype=[("x", "f4")]), "expected numbers"),
        (np.full((10, 19), None), "cannot be read as .npy"),
        (np.full((10, 19), 1e300), "holds 1e+300 in frame 0, column 0"),
        (np.zeros((10, 19)), "has norm 0.000, expected 1"),
        (np.zeros((10, 20)), "shape (10, 20), expected (frames, 19)"),
    ],
)
def test_broken_arrays_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], array: np.ndarray, reason: str
) -> None:
    path = npy(tmp_path / "m.npy", array)
    code, said, _ = imported(path, capsys, "--format", "qpos", "--rate", "50")
    assert code == 2
    assert_one_line(said, reason)


def test_an_array_that_claims_more_than_its_file_holds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "m.npy"
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000, 19), }".ljust(117) + "\n"
    path.write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + bytes(1000))
    code, said, _ = imported(path, capsys, "--format", "qpos", "--rate", "50")
    assert code == 2
    assert_one_line(said, "cannot be read as .npy")


@pytest.mark.parametrize(("dtype", "tolerance"), [("<f4", 1e-6), (">f8", 1e-6), ("<f2", 1e-3)])
def test_floats_of_every_kind(tmp_path: Path, capsys: pytest.CaptureFixture[str], dtype: str, tolerance: float) -> None:
    path = npy(tmp_path / "m.npy", np.asfortranarray(qpos_of(shipped()).astype(dtype)))
    code, said, clip = imported(path, capsys, "--format", "qpos", "--rate", "50")
    assert code == 0, said
    np.testing.assert_allclose(load_clip(clip).joint_position, shipped().joint_position, atol=tolerance)


@pytest.mark.parametrize(
    "option",
    [
        *(f"--frequency {value}" for value in ("-2", "inf", "1e9", "0", "nan", "13")),
        *(f"--rate {value}" for value in ("-50", "inf", "1e9", "0", "nan")),
        *(f"--steady {value}" for value in (".6 0 nan", "inf 0 0", "0 1e9 0", "0 0 -1e9")),
        "--frequency fast",
        "--leg-order FL,FL,RL,RR",
        "--foot-order FL",
        "--velocity-frame body",
        "--velocity-frame base,base,base",
        "--quaternion-order zyxw",
        "--name ../clip",
    ],
)
def test_options_are_checked_and_a_good_clip_stays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str
) -> None:
    path = exported(tmp_path / "motion.txt", lambda frames: frames)
    clip = imported(path, capsys)[2]
    good = clip.read_bytes()
    code, said, _ = imported(path, capsys, "--overwrite", *option.split())
    assert code == 2
    assert_one_line(said, option.split()[0])
    assert clip.read_bytes() == good


def test_five_rows_say_what_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = exported(tmp_path / "motion.txt", lambda frames: frames[:5])
    code, said, _ = imported(path, capsys)
    assert code == 2
    assert_one_line(said, "no stride frequency can be measured")
    code, said, clip = imported(path, capsys, "--frequency", "2")
    assert code == 0 and len(load_clip(clip)) == 5
    assert "note: 5 rows are 4 transitions, 0.2 strides" in said


def test_another_frequency_than_the_contacts_is_noted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = exported(tmp_path / "motion.txt", lambda frames: frames)
    assert "note: by its contacts it steps at 2.00 Hz, not 4 Hz" in imported(path, capsys, "--frequency", "4")[1]


def read_in(order: tuple[int, ...]) -> tuple[str, ...]:
    return tuple(FOOT_NAMES[leg] for leg in order)


@pytest.mark.parametrize("name", ["trot_2hz_forward_0.6", "pronk_2hz_in_place"])
def test_every_pair_of_orders_is_told(name: str) -> None:
    """Joints in one of 24 orders, feet in one of 24: named together, and right once they are pasted."""
    clip = load_clip(FOLDER / f"{name}.npz")
    joints = clip.joint_position[::10].astype(np.float64)
    feet = feet_of(GO2, joints)
    orders = list(permutations(range(4)))
    for leg_order in orders:
        file_joints = joints.reshape(-1, 4, 3)[:, leg_order].reshape(-1, 12)
        for foot_order in orders:
            file_feet = feet[:, foot_order].reshape(-1, 12)
            options = asked_for(file_joints, file_feet)
            expected = [f"--leg-order {','.join(read_in(leg_order))}"]
            if foot_order != leg_order:
                expected.append(f"--foot-order {','.join(read_in(foot_order))}")
            assert options == (" ".join(expected) if (leg_order, foot_order) != ((0, 1, 2, 3),) * 2 else "")


def asked_for(file_joints: np.ndarray, file_feet: np.ndarray) -> str:
    """The options that reading in the project's own order asks for."""
    still = np.tile([1.0, 0.0, 0.0, 0.0], (len(file_joints), 1))
    motion = Motion(
        50.0,
        still[:, :3],
        still,
        by_leg(file_joints, FOOT_NAMES),
        foot_position=by_leg(file_feet, FOOT_NAMES).reshape(-1, 4, 3),
    )
    try:
        check_feet(GO2, motion, trust_joints=False)
    except ClipError as error:
        return REMEDY.findall(str(error))[-1].strip()
    return ""


def test_export_keeps_what_is_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, output = FOLDER / "trot_2hz_forward_0.6.npz", tmp_path / "trot.txt"
    output.write_text("precious")
    code, _, err = run(capsys, "export", source, "--format", "amp", output)
    assert code == 2 and output.read_text() == "precious"
    assert_one_line(err, "is there already; pass --overwrite or another name")
    assert run(capsys, "export", source, "--format", "amp", output, "--overwrite")[0] == 0
    assert output.read_text().startswith("{")
    code, _, err = run(capsys, "export", source, "--format", "amp", output / "below" / "trot.txt")
    assert code == 2
    assert_one_line(err, "choose a folder that can be written")
