"""Motion of other projects becomes clips: what is read is what was written."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camp.common.errors import ClipError
from camp.gaits.schedule import GAIT_PHASES
from camp.metrics.gait import measure_gait
from camp.motion.clips.clip import amp_state
from camp.motion.clips.store import load_clip
from camp.motion.exchange.convert import import_motion, resample
from camp.motion.exchange.exporter import export_amp
from camp.motion.exchange.motion import ImportOptions, Motion, derive_velocities
from camp.motion.exchange.rotations import continuous, multiply, rotate, rotate_inverse, slerp
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from tests.motion.exchange.foreign import (
    FOLDER,
    NAMES,
    TROT,
    amp_frames,
    edit,
    kine2go_table,
    motion_of,
    qpos_of,
    resampled_table,
    shipped,
    write_qpos,
)

# What the format keeps: a float32 as it is; feet and their velocities are computed anew from float32 joints.
EXACT = ("base_position", "joint_position", "joint_velocity", "base_linear_velocity", "base_angular_velocity")
CLOSE = {"base_quaternion": 1e-6, "foot_position": 2e-6, "foot_velocity": 2e-4}  # 1, m, m/s


@pytest.fixture
def amp(tmp_path: Path) -> Path:
    export_amp(tmp_path / "trot.txt", shipped())
    return tmp_path / "trot.txt"


@pytest.mark.parametrize("name", NAMES)
def test_round_trip_of_the_text_format(tmp_path: Path, name: str) -> None:
    clip = shipped(name)
    export_amp(tmp_path / "motion.txt", clip)
    back = import_motion(tmp_path / "motion.txt", "amp", ImportOptions(GO2, gait=clip.gait))
    for field in EXACT:
        np.testing.assert_array_equal(getattr(back, field), getattr(clip, field), err_msg=field)
    for field, tolerance in CLOSE.items():
        np.testing.assert_allclose(getattr(back, field), getattr(clip, field), atol=tolerance, err_msg=field)
    np.testing.assert_allclose(amp_state(back), amp_state(clip), atol=2e-6)  # what the discriminators see
    assert (back.dt, back.gait, back.source) == (clip.dt, clip.gait, "amp")
    assert back.frequency_hz == pytest.approx(clip.frequency_hz, rel=0.02)


def test_round_trip_of_every_shipped_clip(tmp_path: Path) -> None:
    clips = [load_clip(path) for path in sorted(FOLDER.glob("*.npz"))[::7]]
    clips = [clip for clip in clips if clip.gait in GAIT_PHASES and clip.source == "expert"]
    assert len(clips) > 10
    for clip in clips:
        export_amp(tmp_path / "motion.txt", clip)
        options = ImportOptions(GO2, gait=clip.gait, frequency_hz=clip.frequency_hz)
        back = import_motion(tmp_path / "motion.txt", "amp", options)
        np.testing.assert_allclose(amp_state(back), amp_state(clip), atol=2e-6)


def test_columns_of_the_text_format_by_hand(amp: Path) -> None:
    """Frame 7: the numbers where the format wants them, the right front leg first."""
    clip, frame = shipped(), json.loads(amp.read_text())["Frames"][7]
    assert len(frame) == 61
    w, x, y, z = clip.base_quaternion[7]
    front_right, rear_left = JOINT_NAMES.index("FR_hip_joint"), JOINT_NAMES.index("RL_hip_joint")
    np.testing.assert_allclose(frame[0:7], [*clip.base_position[7], x, y, z, w], rtol=1e-6)
    np.testing.assert_allclose(frame[7:10], clip.joint_position[7, front_right : front_right + 3], rtol=1e-6)
    np.testing.assert_allclose(frame[16:19], clip.joint_position[7, rear_left : rear_left + 3], rtol=1e-6)
    np.testing.assert_allclose(frame[19:22], clip.foot_position[7, FOOT_NAMES.index("FR")], rtol=1e-6)
    np.testing.assert_allclose(frame[25:28], clip.foot_position[7, FOOT_NAMES.index("RR")], rtol=1e-6)
    np.testing.assert_allclose(frame[31:34], clip.base_linear_velocity[7], rtol=1e-6)
    np.testing.assert_allclose(frame[34:37], clip.base_angular_velocity[7], rtol=1e-6)
    np.testing.assert_allclose(frame[40:43], clip.joint_velocity[7, 0:3], rtol=1e-6)  # FL is second
    np.testing.assert_allclose(frame[58:61], clip.foot_velocity[7, FOOT_NAMES.index("RL")], rtol=1e-6)


def test_contact_is_estimated_close_to_the_simulated_one(tmp_path: Path) -> None:
    """Measured on the clips at 2 and 3 Hz: .94 of rows and feet agree on average, .89 in the worst clip.

    At 4 Hz, 12.5 rows a stride, two trots' differentiated velocities miss the rate check (docs/motions.md).
    """
    for path in sorted(FOLDER.glob("*.npz"))[::9]:
        clip = load_clip(path)
        if clip.gait not in GAIT_PHASES or not clip.is_steady or clip.frequency_hz > 3.5:
            continue
        options = ImportOptions(GO2, gait=clip.gait, rate_hz=1.0 / clip.dt)
        back = import_motion(write_qpos(tmp_path / "motion.npy", qpos_of(clip)), "qpos", options)
        assert (back.foot_contact == clip.foot_contact).mean() > 0.85, path.name
        measured = measure_gait(back.foot_contact[None], back.dt)
        assert measured.label[0] == clip.gait, path.name
        assert back.frequency_hz == pytest.approx(clip.frequency_hz, rel=0.03), path.name


def test_command_is_the_mean_twist_of_a_stride(amp: Path) -> None:
    clip, back = shipped(), import_motion(amp, "amp", TROT)
    assert back.command.shape == (len(back), 3)
    np.testing.assert_allclose(back.command[20:-20] - clip.command, 0.0, atol=0.06)
    given = import_motion(amp, "amp", replace(TROT, command=(0.6, 0.0, 0.0)))
    assert given.is_steady and given.split == "steady"
    np.testing.assert_array_equal(given.command, np.float32([0.6, 0.0, 0.0]))


def test_targets_are_unknown_and_say_so(amp: Path) -> None:
    back = import_motion(amp, "amp", TROT)
    assert not back.has_targets and shipped().has_targets
    np.testing.assert_array_equal(back.joint_target[:-1], back.joint_position[1:])
    np.testing.assert_array_equal(back.joint_target_applied, back.joint_target)
    assert not back.joint_torque.any()


@pytest.mark.parametrize("forward_differences", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_text_format_at_47_hz(tmp_path: Path, name: str, forward_differences: bool) -> None:
    """A motion taken at 47.6 Hz, as the published files are, comes back at 50 Hz along the same path."""
    clip = shipped(name)
    path = tmp_path / "slow.txt"
    path.write_text(json.dumps({"FrameDuration": 0.021, "Frames": amp_frames(clip, 1 / 0.021, forward_differences)}))
    back = import_motion(path, "amp", ImportOptions(GO2, gait=clip.gait))
    rows = len(back)
    assert back.dt == 0.02
    assert rows == pytest.approx(len(clip), abs=3)
    tolerances = {"base_position": 2e-3, "base_quaternion": 2e-3, "joint_position": 0.03, "joint_velocity": 1.2}
    for field, tolerance in tolerances.items():
        difference = getattr(back, field) - getattr(clip, field)[:rows]
        assert np.sqrt(np.mean(difference**2)) < tolerance, field
    assert back.frequency_hz == pytest.approx(clip.frequency_hz, rel=0.03)


def test_resampling_at_the_same_rate_changes_nothing() -> None:
    motion = motion_of(shipped())
    again = resample(motion)
    np.testing.assert_array_equal(again.joint_position, motion.joint_position)
    np.testing.assert_allclose(again.base_quaternion, motion.base_quaternion, atol=1e-12)


def test_slerp_halves_the_angle() -> None:
    start, end = np.array([[1.0, 0, 0, 0]]), np.array([[np.cos(0.4), 0, 0, np.sin(0.4)]])  # 0.8 rad about z
    middle = slerp(start, end, np.array([[0.5]]))
    np.testing.assert_allclose(middle, [[np.cos(0.2), 0, 0, np.sin(0.2)]])
    np.testing.assert_allclose(slerp(start, start, np.array([[0.3]])), start)


def test_velocities_of_a_screw_motion_by_hand() -> None:
    """Turning at 2 rad/s about its own x axis while that points along world y, and moving at .5 m/s along y."""
    times = np.arange(40) / 100.0
    spin = np.stack([np.cos(times), np.sin(times), 0 * times, 0 * times], axis=1)  # 2 rad/s about x
    facing = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])  # x along world y
    signs = np.where(np.arange(40) % 3 == 0, -1.0, 1.0)[:, None]  # q and -q are one rotation
    quaternion = continuous(signs * multiply(np.broadcast_to(facing, spin.shape), spin))
    position = np.stack([0 * times, 0.5 * times, 0.3 + 0 * times], axis=1)
    velocities = derive_velocities(Motion(100.0, position, quaternion, np.tile(times[:, None] * 3.0, 12)))
    np.testing.assert_allclose(velocities.base_angular, np.tile([2.0, 0, 0], (40, 1)), atol=1e-9)
    np.testing.assert_allclose(velocities.base_linear, np.tile([0.5, 0, 0], (40, 1)), atol=1e-9)
    np.testing.assert_allclose(velocities.joint, 3.0)


@pytest.mark.parametrize("rate", [50.0, 60.0, 120.0])
def test_qpos_from_npy_and_csv(tmp_path: Path, rate: float) -> None:
    clip = shipped(NAMES[1])
    table = resampled_table(clip, rate)
    options = ImportOptions(GO2, gait="pace", rate_hz=rate)
    binary = import_motion(write_qpos(tmp_path / "m.npy", table), "qpos", options)
    np.savetxt(tmp_path / "m.csv", table, delimiter=",", fmt="%.9g")
    text = import_motion(tmp_path / "m.csv", "qpos", options)
    np.testing.assert_allclose(text.joint_position, binary.joint_position, atol=1e-6)
    rows = len(binary)
    for field, tolerance in (("joint_position", 0.03), ("base_linear_velocity", 0.05), ("base_angular_velocity", 0.25)):
        difference = getattr(binary, field) - getattr(clip, field)[:rows]
        assert np.sqrt(np.mean(difference**2)) < tolerance, field


def test_qpos_joints_by_name(tmp_path: Path) -> None:
    clip = shipped()
    table, names = qpos_of(clip), [*"xyz", "qw", "qx", "qy", "qz", *JOINT_NAMES]
    shuffled = [*range(7), *np.random.default_rng(0).permutation(np.arange(7, 19))]
    header = ",".join(names[column] for column in shuffled)
    np.savetxt(tmp_path / "named.csv", table[:, shuffled], delimiter=",", header=header, comments="")
    back = import_motion(tmp_path / "named.csv", "qpos", replace(TROT, rate_hz=50.0))
    np.testing.assert_allclose(back.joint_position, clip.joint_position, atol=1e-6)
    (tmp_path / "named.csv").write_text("time,a,b\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n")
    with pytest.raises(ClipError, match=r"shape \(4, 3\), expected \(frames, 19\)"):
        import_motion(tmp_path / "named.csv", "qpos", replace(TROT, rate_hz=50.0))


def test_legs_in_another_order(tmp_path: Path) -> None:
    clip = shipped()
    table = qpos_of(clip)
    order = ("RR", "FL", "RL", "FR")
    table[:, 7:] = table[:, 7:].reshape(-1, 4, 3)[:, [FOOT_NAMES.index(leg) for leg in order]].reshape(-1, 12)
    options = ImportOptions(GO2, gait="trot", rate_hz=50.0, leg_order=order)
    back = import_motion(write_qpos(tmp_path / "m.npy", table), "qpos", options)
    np.testing.assert_array_equal(back.joint_position, clip.joint_position)
    with pytest.raises(ClipError, match="--leg-order FL,FL,RL,FR: name each of FL,FR,RL,RR once"):
        import_motion(tmp_path / "m.npy", "qpos", replace(options, leg_order=("FL", "FL", "RL", "FR")))


@pytest.mark.parametrize("joints_by_kind", [False, True])
def test_kine2go(tmp_path: Path, joints_by_kind: bool) -> None:
    clip = shipped(NAMES[2])
    np.save(tmp_path / "motion.npy", kine2go_table(clip, joints_by_kind))
    back = import_motion(tmp_path / "motion.npy", "kine2go", ImportOptions(GO2, gait="bound"))
    rows = len(back)
    assert np.sqrt(np.mean((back.joint_position - clip.joint_position[:rows]) ** 2)) < 0.03
    assert np.sqrt(np.mean((back.base_linear_velocity - clip.base_linear_velocity[:rows]) ** 2)) < 0.06
    assert measure_gait(back.foot_contact[None], 0.02).label[0] == "bound"


def test_zero_velocities_are_absent_ones(amp: Path) -> None:
    def without(frames: np.ndarray) -> np.ndarray:
        frames[:, 31:] = 0.0
        frames[:, 19:31] = 0.0
        return frames

    clip, back = shipped(), import_motion(edit(amp, Frames=without), "amp", TROT)
    np.testing.assert_allclose(back.foot_position, clip.foot_position, atol=2e-6)
    assert np.sqrt(np.mean((back.joint_velocity - clip.joint_velocity) ** 2)) < 0.5


def test_rotations_agree_with_each_other() -> None:
    rng = np.random.default_rng(1)
    quaternion = continuous(rng.standard_normal((50, 4)))
    vector = rng.standard_normal((50, 3))
    np.testing.assert_allclose(rotate_inverse(quaternion, rotate(quaternion, vector)), vector, atol=1e-12)
    again = rotate(multiply(quaternion, quaternion), vector)
    np.testing.assert_allclose(again, rotate(quaternion, rotate(quaternion, vector)), atol=1e-12)
