"""The validator passes what is shipped and catches what is broken on purpose, each with the right reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camp.common.paths import assets_root
from camp.gaits.schedule import nominal_duty, nominal_flight
from camp.metrics.gait import measure_gait
from camp.motion.clips.clip import SPLITS, Clip
from camp.motion.clips.store import load_clip
from camp.motion.dataset.report import failure_table, quality_tables, worst_by_cell, worst_table
from camp.motion.dataset.requests import shipped_requests
from camp.motion.dataset.validate import check_clip, heading_velocity, replay_error, rotation_matrix
from camp.robots.go2 import GO2

FOLDER = assets_root() / "motions" / "go2"
LARGEST_SET = 25e6  # bytes
REPLAYED = ("trot_2hz_forward_1", "pace_4hz_left_0.25", "bound_3hz_turn_left_0.6", "pronk_2hz_pushed_00001")


def single(values: list[float]) -> np.ndarray:
    return np.array(values, dtype=np.float32)


def shipped(name: str) -> Clip:
    return load_clip(FOLDER / f"{name}.npz")


def failed(clip: Clip, replay: bool = False) -> set[str]:
    return {check.name for check in check_clip(GO2, clip, replay=replay) if not check.passed}


@pytest.fixture(scope="module")
def clips() -> dict[str, Clip]:
    return {path.stem: load_clip(path) for path in sorted(FOLDER.glob("*.npz"))}


def test_all_requests_are_shipped(clips: dict[str, Clip]) -> None:
    requests = {request.name: request for request in shipped_requests(GO2)}
    assert clips.keys() == requests.keys()
    for name, clip in clips.items():
        request = requests[name]
        assert (len(clip), clip.dt) == (200, 0.02), name
        assert (clip.gait, clip.frequency_hz) == (request.gait, request.frequency_hz), name
        assert (clip.split, clip.seed, clip.previous_gait) == (request.split, request.seed, request.previous_gait), name
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < LARGEST_SET


@pytest.mark.parametrize("split", [split for split in SPLITS if split != "perturbed"])
def test_shipped_clips_are_good(clips: dict[str, Clip], split: str) -> None:
    chosen = {name: clip for name, clip in clips.items() if clip.split == split}
    assert chosen
    assert {name: failed(clip) for name, clip in chosen.items() if failed(clip)} == {}


def test_gait_metric_labels_every_steady_clip(clips: dict[str, Clip]) -> None:
    steady = [clip for clip in clips.values() if clip.split == "steady"]
    measured = measure_gait(np.stack([clip.foot_contact for clip in steady]), 0.02)
    assert measured.label.tolist() == [clip.gait for clip in steady]
    np.testing.assert_allclose(measured.frequency_hz, [clip.frequency_hz for clip in steady], rtol=0.03)


def test_transitions_end_in_their_gait(clips: dict[str, Clip]) -> None:
    """A second before the change the feet show the previous gait, in the last second the other one."""
    for name, clip in clips.items():
        if clip.split == "transition":
            before = clip.foot_contact[clip.switch_step - 50 : clip.switch_step]
            labels = measure_gait(np.stack([before, clip.foot_contact[-50:]]), clip.dt).label.tolist()
            assert labels == [clip.previous_gait, clip.gait], name


@pytest.mark.parametrize("name", REPLAYED)
def test_shipped_clips_replay(name: str) -> None:
    assert replay_error(GO2, shipped(name)) < 0.05


def test_replay_notices_other_targets() -> None:
    clip = shipped("trot_2hz_forward_0.6")
    shifted = np.roll(clip.joint_target_applied, 10, axis=0)  # .2 s late: a different phase of the stride
    assert replay_error(GO2, replace(clip, joint_target_applied=shifted)) > 0.1


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
    other_gait = replace(clip, gait="pace")
    assert {"phase error (strides)", "contact match"} <= failed(other_gait)
    assert failed(replace(other_gait, split="perturbed", command=np.tile(clip.command, (200, 1)))) == set()


def test_clips_without_targets_are_not_replayed() -> None:
    clip = shipped("trot_3hz_forward_0.6")
    imported = replace(clip, source="amp", joint_target=clip.joint_position, joint_target_applied=clip.joint_target)
    assert failed(imported, replay=True) == set()


@pytest.mark.parametrize(
    ("gait", "frequency", "duty", "flight"),
    [("trot", 2.0, 0.5, 0.0), ("trot", 2.5, 0.5, 0.0), ("pronk", 2.5, 0.55, 0.45), ("bound", 4.0, 5 / 12, 1 / 6)],
)
def test_nominal_duty_and_flight(gait: str, frequency: float, duty: float, flight: float) -> None:
    assert nominal_duty(gait, frequency) == pytest.approx(duty)
    assert nominal_flight(gait, frequency) == pytest.approx(flight, abs=1e-3)


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
    checks = check_clip(GO2, shipped("pace_3hz_in_place"), replay=False)
    worse = [replace(check, value=check.value + (0.5 if check.bound == "<=" else -0.5)) for check in checks]
    results = {"good": checks, "bad": worse}
    table = worst_table(results)
    assert [*table.columns[1].cells] == ["bad"] * len(checks)
    assert [str(cell) for cell in table.columns[2].cells] == [
        f"{check.value:.3f}" for check in sorted(worse, key=lambda check: check.passed)
    ]
    failed = [check for check in worse if not check.passed]
    assert [*failure_table(results).columns[1].cells] == [check.name for check in failed]
    for blocks in (quality_tables(results, 80), quality_tables(results, 1000)):
        assert sum(len(block.columns) - 1 for block in blocks) == len(checks)
        assert all([*block.columns[0].cells] == ["bad", "good"] for block in blocks)  # failures first


def test_worst_of_a_cell() -> None:
    names = ("pace_3hz_in_place", "pace_3hz_left_0.25", "trot_3hz_in_place")
    clips = {name: shipped(name) for name in names}
    results = {name: check_clip(GO2, clip, replay=False) for name, clip in clips.items()}
    worst = worst_by_cell(clips, results)
    assert list(worst) == [("steady", "trot", 3.0), ("steady", "pace", 3.0)]
    slip = [check.value for name in names[:2] for check in results[name] if check.name == "stance slip (m/s)"]
    assert worst["steady", "pace", 3.0]["stance slip (m/s)"].value == max(slip)
    match = [check.value for name in names[:2] for check in results[name] if check.name == "contact match"]
    assert worst["steady", "pace", 3.0]["contact match"].value == min(match)
