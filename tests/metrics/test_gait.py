"""Gait measurement on synthetic contact sequences with known answers."""

from __future__ import annotations

import timeit

import numpy as np
import pytest

from camp.common.paths import assets_root
from camp.gaits.schedule import GAIT_PHASES
from camp.metrics.gait import label_over_time, measure_gait, pair_phase_errors, phase_error, switch_time
from camp.motion.clips.store import load_clips
from camp.robots.go2 import GO2

PERIOD = 0.02  # s


def contact_sequence(gait: str, frequency_hz: float, duty: float, start: float, steps: int) -> np.ndarray:
    """(T, 4) bool: a leg stands while frequency * time + start - offset, modulo 1, is below the duty."""
    stride = np.arange(steps)[:, None] * PERIOD * frequency_hz + start - np.asarray(GAIT_PHASES[gait])
    return np.mod(stride, 1.0) < duty


def flicker(contact: np.ndarray, fraction: float, rng: np.random.Generator) -> np.ndarray:
    return contact ^ (rng.random(contact.shape) < fraction)


@pytest.fixture(scope="module")
def grid():
    """All gaits x 1.5-4 Hz x duty .4-.65, any start, 3.74 s (no whole number of strides), 2 % flicker."""
    rng = np.random.default_rng(0)
    truth = [
        (gait, frequency, duty)
        for gait in GAIT_PHASES
        for frequency in np.linspace(1.5, 4.0, 26)
        for duty in (0.4, 0.45, 0.5, 0.55, 0.6, 0.65)
    ]
    contact = np.stack(
        [flicker(contact_sequence(case[0], case[1], case[2], rng.random(), 187), 0.02, rng) for case in truth]
    )
    return truth, contact


def test_frequency_within_three_percent(grid):
    truth, contact = grid
    frequency = np.array([case[1] for case in truth])
    np.testing.assert_allclose(measure_gait(contact, PERIOD).frequency_hz, frequency, rtol=0.03)


def test_phase_of_each_leg_within_a_twentieth_stride(grid):
    truth, contact = grid
    offset = np.array([GAIT_PHASES[case[0]] for case in truth])
    error = measure_gait(contact, PERIOD).phase - offset
    assert np.abs(error - np.round(error)).max() < 0.05


def test_duty_and_flight(grid):
    truth, contact = grid
    measured = measure_gait(contact, PERIOD)
    duty = np.array([case[2] for case in truth])
    # 2 % flicker moves the expected duty to .98 d + .02 (1 - d); a 20-ms step is up to 8 % of a stride at 4
    # Hz.
    np.testing.assert_allclose(measured.duty.mean(axis=1), 0.96 * duty + 0.02, atol=0.05)
    pronk = np.array([case[0] == "pronk" for case in truth])
    np.testing.assert_allclose(measured.flight_fraction[pronk], 0.98**4 * (1 - duty[pronk]), atol=0.07)


@pytest.mark.parametrize("steps", [50, 75, 100, 187, 400])
def test_every_label_is_right(grid, steps):
    truth, _ = grid
    rng = np.random.default_rng(steps)
    contact = np.stack([flicker(contact_sequence(c[0], c[1], c[2], rng.random(), steps), 0.02, rng) for c in truth])
    assert measure_gait(contact, PERIOD).label.tolist() == [case[0] for case in truth]


def test_hand_worked_trot():
    # 2 Hz = 25 steps a stride; FL, RR stand in rows 0-9 of each stride, FR, RL in rows 12-21; two strides and
    # five rows.
    stride = np.zeros((25, 4), dtype=bool)
    stride[0:10, [0, 3]] = True
    stride[12:22, [1, 2]] = True
    contact = np.concatenate([stride, stride, stride[:5]])
    measured = measure_gait(contact[None], PERIOD)
    assert measured.frequency_hz[0] == pytest.approx(2.0, rel=1e-3)
    # Whole strides only: 20 of 50 rows. The fractional window would say 25 of 55 = .4545 for FL, 20 of 55 =
    # .3636 for FR.
    np.testing.assert_allclose(measured.duty[0], 10 / 25, atol=2e-3)
    np.testing.assert_allclose(measured.phase[0], [0, 12 / 25, 12 / 25, 0], atol=2e-3)
    assert measured.flight_fraction[0] == pytest.approx(5 / 25, abs=2e-3)  # rows 10, 11, 22, 23, 24
    assert measured.label[0] == "trot"


def test_phase_is_the_delay_after_front_left():
    # A walk, every leg a quarter stride after the one before: FL, RR, FR, RL. It is none of the four gaits.
    delay = np.array([0.0, 0.5, 0.75, 0.25])
    contact = np.mod((np.arange(150)[:, None] + 0.5) / 20 - delay, 1.0) < 0.6  # 20 steps a stride
    measured = measure_gait(contact[None], PERIOD)
    np.testing.assert_allclose(measured.phase[0], delay, atol=1e-3)
    assert measured.frequency_hz[0] == pytest.approx(2.5, rel=1e-3)
    assert measured.label[0] == "none"


def still(value: bool) -> np.ndarray:
    return np.full((100, 4), value)


def lame() -> np.ndarray:
    contact = contact_sequence("trot", 2.0, 0.5, 0.1, 100)
    contact[:, 2] = False
    return contact


def sparse_taps() -> np.ndarray:
    return contact_sequence("trot", 2.0, 0.08, 0.1, 100)


@pytest.mark.parametrize(
    "contact",
    [still(True), still(False), lame(), sparse_taps(), contact_sequence("pronk", 0.7, 0.5, 0.0, 50)],
    ids=["standing", "flight", "one lame foot", "taps of 8 % duty", "less than a stride"],
)
def test_no_gait(contact):
    assert measure_gait(contact[None], PERIOD).label[0] == "none"


def test_standing_has_no_frequency_and_full_duty():
    measured = measure_gait(still(True)[None], PERIOD)
    assert np.isnan(measured.frequency_hz[0]) and np.isnan(measured.phase).all()
    np.testing.assert_allclose(measured.duty, 1.0)
    np.testing.assert_allclose(measured.flight_fraction, 0.0, atol=1e-12)
    assert not measured.stepping.any()


def test_a_lame_foot_leaves_the_others_measured():
    measured = measure_gait(lame()[None], PERIOD)
    assert measured.stepping[0].tolist() == [True, True, False, True]
    assert measured.frequency_hz[0] == pytest.approx(2.0, rel=0.01)
    assert np.isnan(measured.phase[0, 2])


@pytest.mark.parametrize("fraction", [0.3, 0.5, 0.8])
def test_random_contacts_are_no_gait(fraction):
    contact = np.random.default_rng(1).random((500, 100, 4)) < fraction
    assert set(measure_gait(contact, PERIOD).label) == {"none"}


def test_wandering_stride_rate_is_still_a_trot():
    # Stride by stride the rate varies by 10 %; over 8 s the phase loses all memory, within 2 s it does not.
    rng = np.random.default_rng(2)
    rate = np.repeat(2.0 * np.exp(rng.normal(0.0, 0.1, 40)), 20)[:400]
    stride = np.cumsum(rate * PERIOD)[:, None] - np.asarray(GAIT_PHASES["trot"])
    measured = measure_gait((np.mod(stride, 1.0) < 0.5)[None], PERIOD)
    assert measured.label[0] == "trot"
    assert measured.frequency_hz[0] == pytest.approx(rate.mean(), rel=0.05)


def test_sequences_are_measured_independently(grid):
    _, contact = grid
    alone = measure_gait(contact[7:8], PERIOD)
    together = measure_gait(contact, PERIOD)
    np.testing.assert_allclose(alone.phase[0], together.phase[7], atol=1e-9)


def test_live_in_training_it_costs_little():
    contact = np.random.default_rng(3).random((256, 100, 4)) < 0.5
    assert min(timeit.repeat(lambda: measure_gait(contact, PERIOD), number=1, repeat=5)) < 0.1


def test_pair_phase_errors_by_hand():
    # The hind pair a tenth of a stride late: the four pairs across front and hind are off by .1, FL-FR and
    # RL-RR by 0.
    phase = np.array([0.9, 0.4, 0.5, 0.0])
    np.testing.assert_allclose(pair_phase_errors(phase, "trot"), [0, 0.1, 0.1, 0.1, 0.1, 0], atol=1e-12)
    assert phase_error(phase, "trot") == pytest.approx(0.4 / 6)


def test_phase_error_between_gaits_is_a_third_of_a_stride():
    for one in GAIT_PHASES:
        for other in GAIT_PHASES:
            error = phase_error(np.array([GAIT_PHASES[one]]), other)
            np.testing.assert_allclose(error, [0.0 if one == other else 1 / 3], atol=1e-12)


def test_label_changes_where_the_gait_does():
    halves = [contact_sequence(gait, 2.0, 0.5, 0.0, 200) for gait in ("trot", "pronk")]
    contact = np.concatenate(halves)
    label = label_over_time(contact, PERIOD)
    assert len(label) == 400
    assert set(label[:175]) == {"trot"} and set(label[225:]) == {"pronk"}
    assert switch_time(label, "pronk", 200, PERIOD) <= 0.5
    assert np.isnan(switch_time(label, "bound", 200, PERIOD))


def test_switch_counts_from_an_unbroken_second():
    label = ["trot"] * 10 + ["pace"] * 49 + ["none"] + ["pace"] * 50
    assert switch_time(label, "pace", 10, PERIOD) == pytest.approx(50 * PERIOD)


def test_wrong_input_is_named():
    with pytest.raises(ValueError, match=r"\(100, 4\)"):
        measure_gait(np.zeros((100, 4), dtype=bool), PERIOD)
    with pytest.raises(ValueError, match="shorter window"):
        label_over_time(np.zeros((20, 4), dtype=bool), PERIOD)


def test_every_steady_clip_is_labelled_right():
    clips = load_clips(GO2, assets_root() / "motions" / "go2", tuple(GAIT_PHASES), ["steady"])
    for clip in clips:
        measured = measure_gait(clip.foot_contact[None], float(clip.dt))
        name = f"{clip.gait} at {clip.frequency_hz} Hz, command {clip.command}"
        assert measured.label[0] == clip.gait, name
        assert measured.frequency_hz[0] == pytest.approx(clip.frequency_hz, rel=0.03), name
        assert pair_phase_errors(measured.phase[0], clip.gait).max() <= 0.05, name
