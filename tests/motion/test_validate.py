"""The validator passes what is shipped and catches what is broken on purpose, each with the right reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camp.metrics.gait import measure_gait
from camp.motion.clips import Clip, load_clip
from camp.motion.gaits import GAIT_PHASES
from camp.motion.report import quality_table
from camp.motion.requests import shipped_requests
from camp.motion.validate import check_clip, heading_velocity, replay_error, rotation_matrix
from camp.paths import assets_root

FOLDER = assets_root() / "motions" / "go2"
LARGEST_SET = 25e6  # bytes
REPLAYED = ("trot_2hz_forward_0.9", "pace_2hz_left_0.25", "bound_3hz_turn_left_0.6", "pronk_2hz_in_place")


def single(values: list[float]) -> np.ndarray:
    return np.array(values, dtype=np.float32)


def shipped(name: str) -> Clip:
    return load_clip(FOLDER / f"{name}.npz")


def failed(clip: Clip, replay: bool = False) -> set[str]:
    return {check.name for check in check_clip(clip, replay=replay) if not check.passed}


def test_all_requests_are_shipped() -> None:
    assert {path.stem for path in FOLDER.glob("*.npz")} == {request.name for request in shipped_requests()}
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < LARGEST_SET


@pytest.mark.parametrize("gait", GAIT_PHASES)
def test_shipped_clips_are_good(gait: str) -> None:
    paths = sorted(FOLDER.glob(f"{gait}_*.npz"))
    assert len(paths) == 24
    for path in paths:
        clip = load_clip(path)
        assert (len(clip), clip.dt, clip.gait) == (200, 0.02, gait), path.name
        assert failed(clip) == set(), path.name


def test_gait_metric_labels_every_shipped_clip() -> None:
    clips = [load_clip(path) for path in sorted(FOLDER.glob("*.npz"))]
    measured = measure_gait(np.stack([clip.foot_contact for clip in clips]), 0.02)
    assert measured.label.tolist() == [clip.gait for clip in clips]
    np.testing.assert_allclose(measured.frequency_hz, [clip.frequency_hz for clip in clips], rtol=0.03)


@pytest.mark.parametrize("name", REPLAYED)
def test_shipped_clips_replay(name: str) -> None:
    assert replay_error(shipped(name)) < 0.05


def test_replay_notices_other_targets() -> None:
    clip = shipped("trot_2hz_forward_0.6")
    shifted = np.roll(clip.joint_target_applied, 10, axis=0)  # .2 s late: a different phase of the stride
    assert replay_error(replace(clip, joint_target_applied=shifted)) > 0.1


def broken_clips() -> dict[str, tuple[Clip, set[str]]]:
    clip = shipped("trot_3hz_forward_0.6")
    w, x, y, z = clip.base_quaternion.T
    other_legs = np.roll(clip.foot_contact, 40, axis=0) & np.array([True, True, False, False])
    return {
        "wrong gait": (replace(clip, gait="bound"), {"phase error (strides)", "contact match"}),
        "wrong frequency": (replace(clip, frequency_hz=2.0), {"frequency error", "contact match"}),
        "wrong rate": (replace(clip, dt=0.04), {"frequency error", "joint velocity mismatch"}),
        "wrong command": (
            replace(clip, command=clip.command + single([0.1, 0, 0])),
            {"speed error (m/s)"},
        ),
        "wrong turn": (replace(clip, command=clip.command + single([0, 0, 0.1])), {"turn error (rad/s)"}),
        "quaternion order": (
            replace(clip, base_quaternion=np.stack([x, y, z, w], 1)),
            {"base velocity mismatch"},
        ),
        "swapped legs": (
            replace(clip, joint_velocity=clip.joint_velocity.reshape(-1, 4, 3)[:, [1, 0, 3, 2]].reshape(-1, 12)),
            {"joint velocity mismatch"},
        ),
        "velocity in the world": (
            replace(clip, base_linear_velocity=clip.base_linear_velocity[:, [1, 0, 2]]),
            {"base velocity mismatch", "speed error (m/s)"},
        ),
        "torque": (replace(clip, joint_torque=clip.joint_torque * 3), {"torque / limit"}),
        "knee beyond its stop": (
            replace(clip, joint_position=clip.joint_position + np.tile([0, 0, 1.0], 4).astype(np.float32)),
            {"joint beyond range (rad)"},
        ),
        "fall": (replace(clip, base_position=clip.base_position - [0, 0, 0.2]), {"lowest base (m)"}),
        "lame": (replace(clip, foot_contact=other_legs), {"contact match", "phase error (strides)"}),
    }


@pytest.mark.parametrize("name", broken_clips())
def test_broken_clip_is_caught(name: str) -> None:
    clip, reasons = broken_clips()[name]
    assert reasons <= failed(clip)


def test_unsteady_clips_are_not_held_to_a_gait() -> None:
    clip = shipped("trot_3hz_forward_0.6")
    varying = replace(clip, command=np.tile(clip.command, (200, 1)), foot_contact=~clip.foot_contact[:, [0, 1, 0, 1]])
    assert failed(varying) == set()


def test_heading_velocity_of_a_turned_robot() -> None:
    clip = shipped("trot_2hz_in_place")
    half = np.sqrt(0.5)  # yaw 90 degrees
    turned = replace(
        clip,
        base_quaternion=np.tile(single([half, 0, 0, half]), (200, 1)),
        base_linear_velocity=np.tile(single([0.3, 0.1, 0]), (200, 1)),
        base_angular_velocity=np.tile(single([0, 0, 0.5]), (200, 1)),
    )
    np.testing.assert_allclose(heading_velocity(turned), np.tile([0.3, 0.1, 0.5], (200, 1)), atol=1e-6)
    np.testing.assert_allclose(
        rotation_matrix(turned.base_quaternion[0]), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-6
    )


def test_table_shows_the_worst() -> None:
    checks = check_clip(shipped("pace_3hz_in_place"), replay=False)
    worse = [replace(check, value=check.value + (0.5 if check.bound == "<=" else -0.5)) for check in checks]
    table = quality_table({"good": checks, "bad": worse})
    assert table.row_count == 2
    for column, check in zip(table.columns[1:], worse, strict=True):
        assert str(column.footer) == f"{check.value:.3f}"
