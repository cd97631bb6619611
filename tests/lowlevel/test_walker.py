"""The policy answers in the robot's order of joints, whatever its own is, and as `camp.deploy` does."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from camp.common.errors import CampError
from camp.deployment.loop import Policy, observe
from camp.lowlevel.walker import Walker
from camp.robots.quadruped import JOINT_NAMES
from tests.lowlevel.rig import reading

POSITION = np.arange(12, dtype=np.float32) / 10


def test_targets_are_those_of_the_policys_own_loop(shipped):
    walker, state = Walker(shipped), reading(tilt=0.1, position=POSITION)
    first = walker.target(state, "pace_2hz", (0.5, 0.0, 0.1))
    velocity, skill = np.array([0.5, 0.0, 0.1], np.float32), shipped.one_hot("pace_2hz")
    frame = observe(shipped, state, velocity, skill, np.zeros(12, np.float32))
    frames = shipped.remembered([], frame)
    expected = shipped.joint_target(np.concatenate(frames))
    np.testing.assert_array_equal(first, expected)
    second = walker.target(state, "pace_2hz", (0.5, 0.0, 0.1))
    action = (expected - np.array(shipped.metadata["default_pose"], np.float32)) / np.float32(0.25)
    frames = shipped.remembered(frames, observe(shipped, state, velocity, skill, action))
    again = shipped.joint_target(np.concatenate(frames))
    np.testing.assert_allclose(second, again, atol=1e-6)
    walker.start()
    np.testing.assert_array_equal(walker.target(state, "pace_2hz", (0.5, 0.0, 0.1)), expected)


class Echo:
    """A policy with its joints in reverse, whose target is the position that it observes; or that fails."""

    metadata: dict[str, Any] = SimpleNamespace(
        robot="go2",
        joint_names=list(JOINT_NAMES[::-1]),
        default_pose=[0.0] * 12,
        kp=list(range(12)),
        kd=[1.0] * 12,
        action_scale=0.25,
        control_period=0.02,
        skills=["trot"],
        observe_skill=True,
        observation=[{"name": "joint_position", "size": 12}],
    ).__dict__
    broken = False

    def one_hot(self, skill: str) -> np.ndarray:
        return np.ones(1, np.float32)

    def remembered(self, frames: list[np.ndarray], frame: np.ndarray) -> list[np.ndarray]:
        return [frame]

    def joint_target(self, observation: np.ndarray) -> np.ndarray:
        if self.broken:
            raise CampError("not finite")
        return observation


def test_joints_go_by_name():
    walker = Walker(cast(Policy, Echo()))
    np.testing.assert_array_equal(walker.target(reading(position=POSITION), "trot", (0, 0, 0)), POSITION)
    assert walker.body().kp.tolist() == list(range(12))[::-1]


def test_an_answer_that_is_no_number_is_none():
    policy = Echo()
    walker = Walker(cast(Policy, policy))
    policy.broken = True
    assert walker.target(reading(position=POSITION), "trot", (0, 0, 0)) is None
