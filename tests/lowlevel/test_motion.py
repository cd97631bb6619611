"""The ways up and down begin and end where they should, without jumps."""

from __future__ import annotations

import numpy as np
import pytest

from camp.lowlevel.messages import Command
from camp.lowlevel.motion import FOLD_S, FOLDED, LIE_S, RISE_S, Way, damping, lie_down, stand_up
from camp.robots.registry import find_robot
from tests.lowlevel.rig import joints, reading

GO2 = find_robot("go2")
POSE = np.array(GO2.default_joint_position, np.float32)
LAST = Command(POSE + 0.3, joints(30.0), joints(1.0))


def up() -> Way:
    return stand_up(reading(position=FOLDED + 0.1), POSE, joints(30.0), joints(1.0))


def test_standing_up_begins_at_the_joints_and_ends_in_the_pose_with_the_policys_gains():
    begin, end = up().at(0.0), up().at(up().seconds)
    np.testing.assert_allclose(begin.target, FOLDED + 0.1)
    np.testing.assert_allclose(up().at(FOLD_S).target, FOLDED, atol=1e-6)
    np.testing.assert_allclose(up().at(FOLD_S + RISE_S).target, POSE, atol=1e-6)
    np.testing.assert_allclose(end.target, POSE, atol=1e-6)
    assert (end.kp == 30.0).all() and (end.kd == 1.0).all()
    np.testing.assert_array_equal(up().at(up().seconds + 10).target, end.target)


def test_lying_down_begins_at_the_last_command_and_ends_folded():
    down = lie_down(LAST, LIE_S)
    np.testing.assert_array_equal(down.at(0.0).target, LAST.target)
    np.testing.assert_array_equal(down.at(0.0).kp, LAST.kp)
    np.testing.assert_allclose(down.at(LIE_S).target, FOLDED, atol=1e-6)


@pytest.mark.parametrize("way", [up(), lie_down(LAST, LIE_S)], ids=["up", "down"])
def test_targets_and_gains_move_without_a_jump(way):
    times = np.arange(0.0, way.seconds + 0.1, 0.02)
    targets, gains = (np.array([getattr(way.at(t), key) for t in times]) for key in ("target", "kp"))
    assert np.abs(np.diff(targets, axis=0)).max() < 0.05  # rad in 20 ms
    assert np.abs(np.diff(gains, axis=0)).max() < 3.0


def test_folded_legs_are_within_the_joints_ranges():
    assert (np.clip(FOLDED, GO2.joint_lower, GO2.joint_upper) == FOLDED).all()


def test_damping_resists_and_holds_nothing():
    assert not damping().kp.any() and (damping().kd > 0).all()
