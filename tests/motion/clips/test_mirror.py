"""Mirror images are motions of their own: the robot can repeat them as well as their twins."""

from __future__ import annotations

import numpy as np
import pytest

from camp.common.paths import assets_root
from camp.motion.clips.clip import Clip
from camp.motion.clips.mirror import mirrored
from camp.motion.clips.stance import foot_stance, with_foot_stance
from camp.motion.clips.store import load_clip
from camp.motion.dataset.validate import check_clip, heading_velocity, replay_error
from camp.robots.go2 import GO2

FOLDER = assets_root() / "motions" / "go2"
NAMES = (
    "trot_3hz_forward_0.5_turn_left_0.4",
    "pace_2hz_left_0.25",
    "bound_3hz_turn_right_0.6",
    "pronk_2hz_in_place",
)


@pytest.fixture(params=NAMES)
def clip(request: pytest.FixtureRequest) -> Clip:
    return load_clip(FOLDER / f"{request.param}.npz")


def test_mirrored_clip_replays_as_well_as_its_twin(clip: Clip) -> None:
    assert replay_error(GO2, mirrored(clip)) < replay_error(GO2, clip) + 0.01


def test_mirrored_clip_passes_every_check(clip: Clip) -> None:
    assert [str(check) for check in check_clip(GO2, mirrored(clip)) if not check.passed] == []


def test_mirroring_twice_gives_the_clip_back(clip: Clip) -> None:
    twice = mirrored(mirrored(clip))
    for name, value in vars(clip).items():
        np.testing.assert_array_equal(getattr(twice, name), value)
        if isinstance(value, np.ndarray):
            assert getattr(twice, name).dtype == value.dtype


def test_the_image_of_a_stance_is_the_stance_of_the_image(clip: Clip) -> None:
    image = mirrored(with_foot_stance(GO2, [clip], 0.005)[0]).foot_stance
    assert image is not None
    # A foot may touch down within rounding of a physics step's end.
    assert (image != foot_stance(GO2, mirrored(clip), 0.005)).mean() < 0.01


def test_the_image_goes_the_other_way(clip: Clip) -> None:
    image = mirrored(clip)
    np.testing.assert_allclose(heading_velocity(image), heading_velocity(clip) * [1, -1, -1], atol=1e-6)
    np.testing.assert_array_equal(image.foot_contact[:, 0], clip.foot_contact[:, 1])
    np.testing.assert_array_equal(image.joint_position[:, 0], -clip.joint_position[:, 3])  # hips
    np.testing.assert_array_equal(image.joint_position[:, 2], clip.joint_position[:, 5])  # calves
