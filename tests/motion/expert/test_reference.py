"""The periodic reference: it must repeat, carry the robot's weight and obey its own model."""

from __future__ import annotations

import numpy as np
import pytest

from camp.gaits.schedule import GAIT_PHASES, GaitSchedule
from camp.motion.expert.leg_momentum import LegMomentum
from camp.motion.expert.parameters import expert_parameters
from camp.motion.expert.reference import PeriodicReference, nominal_footholds
from camp.motion.expert.rigid_body import RigidBody
from camp.robots.go2 import GO2

BODY = RigidBody(mass=15.2, inertia=np.diag([0.17, 0.48, 0.53]))
COMMAND = np.array([0.5, 0.1, 0.3])
CASES = [(gait, frequency) for gait in GAIT_PHASES for frequency in (2.0, 4.0)]


def solve(gait: str, frequency: float, command: np.ndarray = COMMAND) -> PeriodicReference:
    schedule = GaitSchedule(gait, frequency)
    parameters = expert_parameters(GO2, gait, frequency)
    reference = PeriodicReference(schedule, BODY, parameters.posture, parameters.reference)
    reference.solve(command, LegMomentum(schedule))
    return reference


@pytest.mark.parametrize(("gait", "frequency"), CASES)
def test_motion_repeats_and_forces_carry_the_weight(gait: str, frequency: float) -> None:
    reference = solve(gait, frequency)
    np.testing.assert_allclose(reference.states[-1], reference.states[0], atol=1e-8)
    # Over a stride momentum does not change: vertical forces average to m g, horizontal ones to zero.
    mean = reference.forces.sum(axis=1).mean(axis=0)
    np.testing.assert_allclose(mean, [0.0, 0.0, 15.2 * 9.81], atol=1e-6)


@pytest.mark.parametrize(("gait", "frequency"), CASES)
def test_forces_obey_schedule_and_friction(gait: str, frequency: float) -> None:
    reference = solve(gait, frequency)
    schedule = reference.schedule
    contact = schedule.contact((np.arange(schedule.grid_steps) + 0.5) * schedule.grid_period)
    assert (reference.forces[~contact] == 0.0).all()
    standing = reference.forces[contact]
    assert (standing[:, 2] >= 2.0 - 1e-6).all()
    assert (np.abs(standing[:, :2]) <= 0.45 * standing[:, 2:] + 1e-6).all()


def test_velocity_is_the_rate_of_position() -> None:
    reference = solve("pronk", 2.0)
    step = reference.schedule.grid_period
    acceleration = reference.forces.sum(axis=1) / BODY.mass - [0.0, 0.0, 9.81]
    np.testing.assert_allclose(np.diff(reference.states[:, 9:12], axis=0), acceleration * step, atol=1e-9)
    moved = reference.states[:-1, 9:12] * step + acceleration * step**2 / 2
    np.testing.assert_allclose(np.diff(reference.states[:, 3:6], axis=0), moved, atol=1e-9)


def test_slow_pronk_flies_as_high_as_ballistics_say() -> None:
    # .2 s of flight: the CoM rises and falls by g t^2 / 8 = 4.9 cm in the air, and dips further in stance.
    reference = solve("pronk", 2.0, np.zeros(3))
    flight = reference.states[12:, 5]
    assert np.ptp(flight) == pytest.approx(9.81 * 0.2**2 / 8, abs=1e-3)


def test_interpolation_meets_the_grid() -> None:
    reference = solve("bound", 2.0)
    for index in (0, 7, 19):
        np.testing.assert_allclose(reference.deviation(index * 0.025 + 1.5), reference.states[index], atol=1e-9)
        np.testing.assert_array_equal(reference.force(index * 0.025 + 1.5), reference.forces[index])


def test_leg_momentum_moves_the_trunk() -> None:
    reference = solve("trot", 2.0)
    momentum = LegMomentum(reference.schedule)
    momentum.table[:, 1] = 0.5 * np.sin(2 * np.pi * (np.arange(20) + 0.5) / 20)
    level = np.ptp(reference.states[:, 1])
    reference.solve(COMMAND, momentum)
    assert np.ptp(reference.states[:, 1]) > level + 0.01
    np.testing.assert_allclose(reference.states[-1], reference.states[0], atol=1e-8)


def test_leg_momentum_is_learnt_by_halves() -> None:
    momentum = LegMomentum(GaitSchedule("trot", 2.0))
    for time in (0.0, 0.01, 0.5):
        momentum.observe(time, np.array([0.0, 0.4, 0.0]))
    momentum.close_stride()
    np.testing.assert_allclose(momentum.table[0], [0.0, 0.2, 0.0])
    assert (momentum.table[1:] == 0.0).all()
    np.testing.assert_allclose(momentum.at(0.0125), [0.0, 0.2, 0.0])  # middle of the first interval
    np.testing.assert_allclose(momentum.at(0.025), [0.0, 0.1, 0.0])  # half-way to the second
    np.testing.assert_allclose(momentum.rate(0.025), [0.0, -0.2 / 0.025, 0.0])


def test_footholds_are_below_the_hips() -> None:
    footholds = nominal_footholds(expert_parameters(GO2, "trot", 2.0).posture)
    np.testing.assert_allclose(footholds.sum(axis=0), 0.0)
    assert (np.sign(footholds[:, :2]) == [[1, 1], [1, -1], [-1, 1], [-1, -1]]).all()
