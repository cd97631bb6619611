"""The session: the walk of the bare control loop, with orders at any time, and the gait measured from its contacts."""

from __future__ import annotations

import numpy as np
import pytest

from camp import deploy
from camp.common.errors import CampError
from camp.play.session import KEPT_S, Measured, Session

WALK = (0.6, 0.0, 0.0)
PUSH_M_S = 0.5


def walk(session: Session, seconds: float) -> None:
    for _ in range(round(seconds / session.robot.model.opt.timestep)):
        session.tick()


def sideways(session: Session) -> float:
    """Velocity of the trunk to its left, m/s."""
    return float(session.robot.velocity[1])


def test_it_walks_as_the_bare_loop_does(session, shipped):
    session.choose("pace_3hz")
    session.steer(WALK)
    walk(session, 1.0)
    done = deploy.walk(shipped, "pace_3hz", WALK, 1.0)
    assert (session.robot.data.qpos == done.qpos[-1]).all()
    assert ([moment.contact for moment in session.moments] == done.contact).all()


def test_the_measured_gait_follows_the_skill(session):
    session.steer(WALK)
    for skill, gait, frequency_hz in (("trot_2hz", "trot", 2.0), ("bound_3hz", "bound", 3.0)):
        session.choose(skill)
        walk(session, 3.0)
        measured = session.measured
        assert (measured.gait, measured.skill) == (gait, skill)
        assert measured.frequency_hz == pytest.approx(frequency_hz, rel=0.15)
        assert measured.velocity is not None and measured.velocity[0] == pytest.approx(0.6, abs=0.15)
    asked = [moment.skill for moment in session.moments]
    assert asked == ["trot_2hz"] * 150 + ["bound_3hz"] * 150


def test_nothing_is_measured_in_the_first_second(session):
    session.steer(WALK)
    walk(session, 0.9)
    assert session.measured == Measured()


def test_only_the_latest_moments_are_kept(session):
    walk(session, KEPT_S + 0.2)
    assert len(session.moments) == round(KEPT_S / session.period_s)
    assert session.contacts().shape == (len(session.moments), 4)


def test_pushes_change_the_velocity_at_once_from_the_right_and_the_left_in_turn(session):
    session.steer(WALK)
    walk(session, 0.4)
    for side in (1, -1):
        before = sideways(session)
        direction = session.push()
        assert np.hypot(*direction) == pytest.approx(1.0)
        assert sideways(session) - before == pytest.approx(side * PUSH_M_S, abs=0.01)  # the trunk tilts a little
        walk(session, 0.2)
        assert session.pushes == (1 if side > 0 else 2)
        assert [moment.pushed for moment in session.moments][-10:] == [True] + [False] * 9


def test_reset_begins_the_same_walk_anew(session):
    session.choose("trot_3hz")
    session.steer(WALK)
    start = session.robot.data.qpos.copy()
    walk(session, 0.5)
    first = session.robot.data.qpos.copy()
    session.tick()  # so that it is in the middle of a control step
    session.push()
    session.reset()
    assert (session.robot.data.qpos == start).all() and not session.moments and session.pushes == 0
    assert (session.skill, session.command) == ("trot_3hz", list(WALK))
    walk(session, 0.5)
    assert (session.robot.data.qpos == first).all()
    assert not any(moment.pushed for moment in session.moments)


def test_after_a_fall_the_motors_only_damp_until_reset(session):
    session.steer(WALK)
    walk(session, 1.5)
    session.robot.data.qpos[3:7] = (0.0, 1.0, 0.0, 0.0)  # on its back
    walk(session, 0.1)
    assert session.fallen
    walk(session, 4.0)
    robot = session.robot
    assert session.measured == Measured()
    assert np.abs(robot.joint_velocity).max() < 0.05  # nobody walks any more
    session.reset()
    assert not session.fallen
    walk(session, 2.0)
    assert not session.fallen and session.measured.gait == "trot"


def test_commands_are_clipped_to_the_range_of_training(session):
    session.steer((5.0, -5.0, 0.1))
    assert session.command == [0.9, -0.25, 0.1]


def test_unknown_skills_are_refused_and_the_old_one_stays(session):
    with pytest.raises(CampError, match=r"skill 'gallop': unknown to this policy; choose one of trot_2hz"):
        session.choose("gallop")
    assert session.skill == "trot_2hz"
