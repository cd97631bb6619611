"""Generation: deterministic, recorded faithfully, resumable, and clear about falls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from camp.common.errors import ClipError
from camp.dataset import main
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clip, save_clip
from camp.motion.dataset.generate import AppliedNoise, generate_clip, generate_dataset
from camp.motion.dataset.requests import (
    PUSH_DURATION,
    ClipRequest,
    Push,
    bearable,
    describe_command,
    perturbed_requests,
    shipped_requests,
)
from camp.motion.dataset.validate import check_clip, heading_velocity
from camp.robots.go2 import GO2
from camp.robots.quadruped import FOOT_NAMES

STEPS = 50  # 1 s
STEADY = ClipRequest("trot", 3.0, (0.4, 0.0, 0.2))
PERTURBED = ClipRequest("pronk", 3.0, (0.3, 0.0, 0.0), seed=5, noise_std=0.05, from_standing=True, split="perturbed")


@pytest.fixture(scope="module")
def steady() -> Clip:
    return generate_clip(GO2, STEADY, STEPS)


@pytest.fixture(scope="module")
def perturbed() -> Clip:
    return generate_clip(GO2, PERTURBED, STEPS)


def test_same_request_same_clip(perturbed: Clip) -> None:
    again = generate_clip(GO2, PERTURBED, STEPS)
    for name, value in vars(perturbed).items():
        np.testing.assert_array_equal(getattr(again, name), value)


def test_seed_changes_the_noise_alone(perturbed: Clip) -> None:
    other = generate_clip(GO2, replace(PERTURBED, seed=6), STEPS)
    np.testing.assert_array_equal(other.joint_target[0], perturbed.joint_target[0])  # before the noise acts
    assert np.abs(other.joint_position - perturbed.joint_position)[-1].max() > 1e-3


def test_steady_clip_walks_as_commanded(steady: Clip) -> None:
    failed = [check for check in check_clip(GO2, steady) if not check.passed]
    assert failed == []
    np.testing.assert_allclose(steady.command, STEADY.command, rtol=1e-6)
    np.testing.assert_array_equal(steady.joint_target, steady.joint_target_applied)
    np.testing.assert_array_equal(steady.base_position[0, :2], [0.0, 0.0])


def test_perturbed_clip_keeps_the_clean_answer(perturbed: Clip) -> None:
    noise = perturbed.joint_target_applied - perturbed.joint_target
    assert noise.std() == pytest.approx(0.05, rel=0.2)
    assert perturbed.command.shape == (STEPS, 3)
    np.testing.assert_allclose(perturbed.command, np.broadcast_to(PERTURBED.command, (STEPS, 3)))  # as asked for
    assert np.abs(perturbed.joint_velocity[0]).max() == 0.0  # from standing
    assert all(check.passed for check in check_clip(GO2, perturbed))


def test_applied_noise_is_correlated() -> None:
    noise = AppliedNoise(0.1, seed=0)
    values = np.array([noise.draw() for _ in range(5000)])
    assert values.std() == pytest.approx(0.1, rel=0.03)
    assert np.mean(values[1:] * values[:-1]) / np.mean(values**2) == pytest.approx(0.5, abs=0.03)


def test_rows_are_the_simulations(steady: Clip) -> None:
    """Feet and velocities of a row against MuJoCo's own kinematics at that row's state."""
    model = GO2.load_model()
    data, row = mujoco.MjData(model), 17
    data.qpos[:] = np.r_[steady.base_position[row], steady.base_quaternion[row], steady.joint_position[row]]
    data.qvel[6:] = steady.joint_velocity[row]
    mujoco.mj_forward(model, data)
    to_base = data.body("base").xmat.reshape(3, 3).T
    for leg, name in enumerate(FOOT_NAMES):
        foot = data.geom(f"{name}_foot")
        np.testing.assert_allclose(steady.foot_position[row, leg], to_base @ (foot.xpos - data.qpos[:3]), atol=1e-5)
        velocity = np.zeros(6)  # of the foot where the base stands still
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_GEOM, model.geom(f"{name}_foot").id, velocity, 0)
        np.testing.assert_allclose(steady.foot_velocity[row, leg], to_base @ velocity[3:], atol=1e-4)


def test_a_course_is_followed() -> None:
    start, end = (0.0, 0.0, 0.0), (0.3, 0.0, 0.2)
    request = ClipRequest("trot", 3.0, start, split="varied", variant="x", course=((0.2, start), (0.7, end)))
    np.testing.assert_allclose(request.command_at(0.45), [0.15, 0.0, 0.1])
    clip = generate_clip(GO2, request, steps=75)
    assert clip.split == "varied"
    np.testing.assert_allclose(clip.command[5], start, atol=1e-6)
    np.testing.assert_allclose(clip.command[40], end, atol=1e-6)
    np.testing.assert_allclose(heading_velocity(clip)[58:].mean(axis=0), end, atol=0.05)


def test_a_push_moves_the_robot_and_it_recovers() -> None:
    pushes = (Push(0.2, (0.0, 40.0)),)
    request = ClipRequest("trot", 3.0, (0.0, 0.0, 0.0), split="recovery", variant="x", pushes=pushes)
    clip, calm = generate_clip(GO2, request, steps=80), generate_clip(GO2, replace(request, pushes=()), steps=80)
    sideways = heading_velocity(clip)[:, 1] - heading_velocity(calm)[:, 1]
    assert np.abs(sideways[:11]).max() < 1e-6  # the row that is pushed first still holds the state before it
    assert sideways[15] == pytest.approx(40.0 * PUSH_DURATION / 15.2, rel=0.4)
    assert np.abs(sideways[70:]).mean() < 0.05
    assert clip.command.shape == (80, 3)


def test_a_lower_body() -> None:
    usual = ClipRequest("pace", 3.0, (0.0, 0.0, 0.0))
    low = replace(usual, height=-0.025)
    heights = [generate_clip(GO2, request, steps=25).base_position[:, 2].mean() for request in (usual, low)]
    assert heights[0] - heights[1] == pytest.approx(0.025, abs=0.005)


def test_a_change_of_gait() -> None:
    request = ClipRequest("pace", 3.0, (0.2, 0.0, 0.0), split="transition", previous_gait="trot")
    clip = generate_clip(GO2, request, steps=160)
    assert (clip.gait, clip.previous_gait, clip.split) == ("pace", "trot", "transition")
    assert 75 < clip.switch_step <= 75 + 17  # the first stride that begins after 1.5 s
    assert request.name == "trot_to_pace_3hz_forward_0.2"
    before, after = clip.foot_contact[:70], clip.foot_contact[110:]
    assert (before[:, 0] == before[:, 3]).mean() > 0.9  # diagonal legs together
    assert (after[:, 0] == after[:, 2]).mean() > 0.9  # legs of a side together


def test_standing() -> None:
    request = ClipRequest("stand", 0.0, (0.0, 0.0, 0.0), split="stand", variant="low", height=-0.05)
    clip = generate_clip(GO2, request, steps=25)
    assert request.name == "stand_low"
    assert clip.foot_contact.all()
    assert np.abs(clip.joint_velocity).max() < 0.1
    assert clip.base_position[:, 2].mean() == pytest.approx(0.237, abs=0.01)


def test_fall_is_an_error() -> None:
    with pytest.raises(ClipError, match="the robot fell"):
        generate_clip(GO2, ClipRequest("pace", 2.0, (0.5, 0.0, 0.0), noise_std=0.6, from_standing=True))


def test_data_set_keeps_good_clips_and_reports_falls(tmp_path: Path, steady: Clip) -> None:
    there = ClipRequest("trot", 2.0, (0.0, 0.0, 0.0))
    save_clip(tmp_path / f"{there.name}.npz", steady)
    broken = ClipRequest("pace", 3.0, (0.0, 0.0, 0.0), seed=3, from_standing=True)
    (tmp_path / f"{broken.name}.npz").write_bytes(b"cut off")
    falls = ClipRequest("pace", 2.0, (0.5, 0.0, 0.0), seed=4, noise_std=0.6, from_standing=True)
    outcomes = {o.request: o for o in generate_dataset(GO2, [there, broken, falls], tmp_path, workers=1)}
    assert {request: outcome.status for request, outcome in outcomes.items()} == {
        there: "kept",
        broken: "made",
        falls: "failed",
    }
    assert "fell" in outcomes[falls].message
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["trot_2hz_in_place.npz", "pace_3hz_perturbed_00003.npz"]
    )
    assert len(load_clip(tmp_path / "pace_3hz_perturbed_00003.npz")) == 200


def test_command_line_judges_clips(tmp_path: Path, steady: Clip, capsys: pytest.CaptureFixture[str]) -> None:
    save_clip(tmp_path / "good.npz", steady)
    assert main(["validate", str(tmp_path)]) == 0
    save_clip(tmp_path / "wrong_gait.npz", replace(steady, gait="pace"))
    (tmp_path / "cut.npz").write_bytes((tmp_path / "good.npz").read_bytes()[:500])
    assert main(["validate", str(tmp_path)]) == 1
    printed = capsys.readouterr()
    assert "3 clips, 2 bad" in printed.out
    assert "cut.npz cannot be read" in printed.err
    assert main(["validate", str(tmp_path / "nothing")]) == 2


def test_names_say_what_is_shown() -> None:
    assert describe_command((0.6, 0.0, 0.0)) == "forward_0.6"
    assert describe_command((-0.4, 0.0, 0.0)) == "backward_0.4"
    assert describe_command((0.5, -0.1, 0.4)) == "forward_0.5_right_0.1_turn_left_0.4"
    assert describe_command((0.0, 0.0, 0.0)) == "in_place"
    assert STEADY.name == "trot_3hz_forward_0.4_turn_left_0.2"
    assert PERTURBED.name == "pronk_3hz_perturbed_00005"


def test_shipped_requests() -> None:
    shipped = shipped_requests(GO2)
    names = [request.name for request in shipped]
    assert len(set(names)) == len(names) <= 310
    cells = {(gait, rate) for gait in ("trot", "pace", "bound", "pronk") for rate in (2.0, 3.0, 4.0)}
    for split in ("steady", "varied", "recovery"):
        assert {(r.gait, r.frequency_hz) for r in shipped if r.split == split} == cells
    changes = {(r.previous_gait, r.gait) for r in shipped if r.split == "transition"}
    assert len(changes) == 12  # every gait into every other
    for gait, rate in cells:
        commands = np.array(
            [r.command for r in shipped if r.split == "steady" and (r.gait, r.frequency_hz) == (gait, rate)]
        )
        assert (commands.min(axis=0) < -0.1).all() and (commands.max(axis=0) >= 0.2).all()
        assert (commands == 0.0).all(axis=1).any()  # stepping in place


def test_what_a_gait_does_not_bear_is_slowed_down() -> None:
    assert bearable("trot", 2.0, (1.0, 0.0, 0.0)) == (1.0, 0.0, 0.0)
    assert bearable("pronk", 2.0, (1.0, 0.1, 0.0)) == (0.8, 0.1, 0.0)  # knee limits
    assert bearable("pronk", 3.0, (1.0, 0.0, 0.4)) == (1.0, 0.0, 0.4)


def test_pushes_leave_alone_what_is_replayed() -> None:
    pushed = [request for request in shipped_requests(GO2) if request.pushes]
    times = np.array([[push.time for push in request.pushes] for request in pushed])
    assert times.min() > 0.5
    force = np.array([push.force for request in pushed for push in request.pushes])
    speed = np.linalg.norm(force, axis=1) * PUSH_DURATION / 15.2
    assert 0.24 < speed.min() < speed.max() < 0.56


def test_perturbed_requests() -> None:
    perturbed = perturbed_requests(96, seed=1)
    assert perturbed == perturbed_requests(96, seed=1) != perturbed_requests(96, seed=2)
    assert perturbed[:10] == perturbed_requests(10, seed=1)  # a larger set contains the smaller one
    assert len({request.name for request in perturbed}) == 96
    assert {request.noise_std for request in perturbed} == {0.0, 0.05, 0.1}
    assert {request.split for request in perturbed} == {"perturbed"}
    assert len({(r.gait, r.frequency_hz) for r in perturbed}) == 12
    assert sum(bool(request.course) for request in perturbed) == 48
