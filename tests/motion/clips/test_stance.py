"""How long feet stand within the control steps of a clip: against MuJoCo, and where nothing is simulated."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from camp.common.errors import ClipError
from camp.common.paths import assets_root
from camp.gaits.schedule import GAIT_PHASES
from camp.motion.clips.clip import amp_state, discriminator_state
from camp.motion.clips.stance import foot_stance, with_foot_stance
from camp.motion.clips.store import load_clip, load_clips, save_clip
from camp.robots.go2 import GO2

BOUND = assets_root() / "motions" / "go2" / "bound_3hz_turn_right_0.6.npz"


def test_rows_are_what_mujoco_does_in_the_control_step_before() -> None:
    clip = load_clip(BOUND)
    stance, model = foot_stance(GO2, clip, 0.005), GO2.load_model(0.005)
    for row in range(20, 60):
        data = mujoco.MjData(model)
        data.qpos[:] = np.concatenate([clip.base_position[row], clip.base_quaternion[row], clip.joint_position[row]])
        world = np.zeros(3)
        mujoco.mju_rotVecQuat(world, clip.base_linear_velocity[row].astype(float), data.qpos[3:7])
        data.qvel[:] = np.concatenate([world, clip.base_angular_velocity[row], clip.joint_velocity[row]])
        data.ctrl[:] = clip.joint_target_applied[row]
        count = np.zeros(4)
        for _ in range(4):
            mujoco.mj_step(model, data)
            count += np.linalg.norm(data.sensordata[:12].reshape(4, 3), axis=1) > 1.0
        np.testing.assert_allclose(stance[row + 1], count / 4)


def test_touchdowns_within_a_control_step_are_seen() -> None:
    stance = foot_stance(GO2, load_clip(BOUND), 0.005)
    assert set(np.unique(stance).tolist()) == {0.0, 0.25, 0.5, 0.75, 1.0}


def test_motion_without_targets_is_refused() -> None:
    with pytest.raises(ClipError, match=r"bound at 3 Hz, imported from amp: .*env\.foot_stance=false"):
        foot_stance(GO2, replace(load_clip(BOUND), source="amp"), 0.005)


def test_targets_of_other_gains_are_refused() -> None:
    softer = replace(GO2, pd_gain_p=tuple(0.9 * gain for gain in GO2.pd_gain_p))
    with pytest.raises(ClipError, match=r"bound at 3 Hz: .* rad away from its next rows"):
        foot_stance(softer, load_clip(BOUND), 0.005)


def test_shipped_clips_are_all_repeated() -> None:
    clips = load_clips(GO2, BOUND.parent, tuple(GAIT_PHASES))
    assert len(with_foot_stance(GO2, clips, 0.005)) == len(clips)


def test_the_stance_follows_the_papers_states_and_goes_into_no_file(tmp_path) -> None:
    clip = load_clip(BOUND)
    np.testing.assert_array_equal(discriminator_state(clip), amp_state(clip))
    (seen,) = with_foot_stance(GO2, [clip], 0.005)
    state = discriminator_state(seen)
    assert state.shape == (len(clip), 47)
    np.testing.assert_array_equal(state[:, :43], amp_state(clip))
    np.testing.assert_array_equal(state[:, 43:], seen.foot_stance)
    save_clip(tmp_path / "bound.npz", seen)
    assert load_clip(tmp_path / "bound.npz").foot_stance is None
