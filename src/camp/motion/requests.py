"""What to generate: one request per clip, and the lists that make up the data sets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camp.motion.gaits import GAIT_PHASES

SHIPPED_FREQUENCIES = (2.0, 3.0)  # Hz
NOISE_LEVELS = (0.0, 0.05, 0.1)  # rad, standard deviation of the noise on the applied target

_COMMANDS: tuple[tuple[float, float, float], ...] = (
    (0.0, 0.0, 0.0),
    (0.3, 0.0, 0.0),
    (0.6, 0.0, 0.0),
    (0.9, 0.0, 0.0),
    (-0.4, 0.0, 0.0),
    (0.0, 0.25, 0.0),
    (0.0, -0.25, 0.0),
    (0.0, 0.0, 0.6),
    (0.0, 0.0, -0.6),
    (0.5, 0.0, 0.4),
    (0.5, 0.0, -0.4),
    (0.4, 0.15, 0.0),
)
# A pronk at 2 Hz flies far: beyond .8 m/s its knees reach their end stop, -.838 rad.
_FASTEST_SLOW_PRONK = 0.8  # m/s
# A pronk at 3 Hz lands late when it moves in two ways at once: its contacts leave the schedule.
_COMPOSITE_FAST_PRONK = 0.7  # times the command
# Ranges of random commands, about as wide as what the policy is asked for (conf/env).
_RANDOM_LOW, _RANDOM_HIGH = np.array([-0.5, -0.25, -0.7]), np.array([0.9, 0.25, 0.7])
_STRAIGHT_SHARE, _IN_PLACE_SHARE = 0.4, 0.1


@dataclass(frozen=True)
class ClipRequest:
    """One clip to generate.

    command: vx, vy in m/s and yaw rate in rad/s; seed: of the noise; noise_std: of the noise on the applied
    joint targets, rad; from_standing: keep the start instead of the steady state alone.
    """

    gait: str
    frequency_hz: float
    command: tuple[float, float, float]
    seed: int = 0
    noise_std: float = 0.0
    from_standing: bool = False

    @property
    def name(self) -> str:
        """File name without suffix."""
        kind = f"perturbed_{self.seed:05d}" if self.from_standing else describe_command(self.command)
        return f"{self.gait}_{self.frequency_hz:g}hz_{kind}"


def describe_command(command: tuple[float, float, float]) -> str:
    """Words for a twist, such as 'forward_0.6', 'forward_0.5_turn_left_0.4' or 'in_place'."""
    words = (("forward", "backward"), ("left", "right"), ("turn_left", "turn_right"))
    parts = [f"{pair[value < 0]}_{abs(value):g}" for pair, value in zip(words, command, strict=True) if value]
    return "_".join(parts) or "in_place"


def shipped_requests() -> list[ClipRequest]:
    """The steady clips of the package: every gait, frequency and command, slowed where the pronk does not bear it."""
    requests = []
    for gait in GAIT_PHASES:
        for frequency in SHIPPED_FREQUENCIES:
            for command in _COMMANDS:
                bearable = _slowed_pronk(frequency, command) if gait == "pronk" else command
                requests.append(ClipRequest(gait, frequency, bearable))
    return requests


def _slowed_pronk(frequency_hz: float, command: tuple[float, float, float]) -> tuple[float, float, float]:
    vx, vy, wz = command
    if frequency_hz < 2.5:
        return min(vx, _FASTEST_SLOW_PRONK), vy, wz
    scale = _COMPOSITE_FAST_PRONK if sum(value != 0.0 for value in command) > 1 else 1.0
    return round(scale * vx, 3), round(scale * vy, 3), round(scale * wz, 3)


def perturbed_requests(count: int, seed: int) -> list[ClipRequest]:
    """`count` clips with noisy targets and random commands, gaits and frequencies in turn."""
    cells = [(gait, frequency) for gait in GAIT_PHASES for frequency in SHIPPED_FREQUENCIES]
    requests = []
    for index in range(count):
        rng = np.random.default_rng((seed, index))
        command = rng.uniform(_RANDOM_LOW, _RANDOM_HIGH)
        command[1:][rng.random(2) < _STRAIGHT_SHARE] = 0.0
        if rng.random() < _IN_PLACE_SHARE:
            command[:] = 0.0
        gait, frequency = cells[index % len(cells)]
        noise = float(rng.choice(NOISE_LEVELS))
        vx, vy, wz = (round(float(value), 3) for value in command)
        requests.append(ClipRequest(gait, frequency, (vx, vy, wz), seed * 100_000 + index, noise, True))
    return requests
