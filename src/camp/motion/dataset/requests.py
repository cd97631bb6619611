"""What to generate: one request per clip, and the lists that make up the data sets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camp.gaits.gait import GAITS, GRID_STEPS
from camp.motion.clips.clip import STAND
from camp.robots.robot import Robot

Twist = tuple[float, float, float]  # vx, vy in m/s and yaw rate in rad/s

SHIPPED_FREQUENCIES = tuple(GRID_STEPS)  # Hz
NOISE_LEVELS = (0.0, 0.05, 0.1)  # rad, standard deviation of the noise on the applied target
PUSH_DURATION = 0.1  # s

_CELLS = [(gait.name, frequency) for gait in GAITS.values() for frequency in gait.duty]
_STEADY: tuple[Twist, ...] = (
    (0.0, 0.0, 0.0),
    (0.3, 0.0, 0.0),
    (0.6, 0.0, 0.0),
    (0.8, 0.0, 0.0),
    (1.0, 0.0, 0.0),
    (-0.4, 0.0, 0.0),
    (0.0, 0.25, 0.0),
    (0.0, -0.25, 0.0),
    (0.0, 0.0, 0.6),
    (0.0, 0.0, -0.6),
    (0.5, 0.0, 0.4),
    (0.5, 0.0, -0.4),
    (0.4, 0.15, 0.0),
    (0.0, -0.15, 0.4),
    (-0.3, 0.0, 0.4),
)

# How far the body goes below or above its usual height, m: more makes a pace at 2 Hz too slow and
# brings a pronk at 2 Hz off its schedule.
LOWER, HIGHER = 0.025, 0.015
# Ranges of random commands, about as wide as what the policy is asked for (conf/env).
_RANDOM_LOW, _RANDOM_HIGH = np.array([-0.5, -0.25, -0.7]), np.array([0.9, 0.25, 0.7])
_STRAIGHT_FRACTION, _IN_PLACE_FRACTION = 0.4, 0.1
_PUSH_SPEED = (0.25, 0.55)  # m/s that a push of the robot's mass is good for
_CHANGES = (0.0, 1.2, 1.3, 2.5, 2.6)  # s, between which a changing command is held or goes over


@dataclass(frozen=True)
class Push:
    """A horizontal force (x, y) in N, world frame, on the base from `time` s of the recording for PUSH_DURATION."""

    time: float
    force: tuple[float, float]


@dataclass(frozen=True)
class ClipRequest:
    """One clip to generate; gait STAND stands.

    command: at the start; seed: of noise and of whatever was drawn at random for this request; noise_std: of
    the noise on the applied joint targets, rad; from_standing: keep the start instead of the steady state alone;
    variant: what is special about it, for the name; course: (time in s, twist) points, joined by straight lines,
    of a command that changes; height: of the CoM above the gait's usual one, m; previous_gait: walked before
    `gait`.
    """

    gait: str
    frequency_hz: float
    command: Twist
    seed: int = 0
    noise_std: float = 0.0
    from_standing: bool = False
    split: str = "steady"
    variant: str = ""
    course: tuple[tuple[float, Twist], ...] = ()
    pushes: tuple[Push, ...] = ()
    height: float = 0.0
    previous_gait: str = ""

    @property
    def name(self) -> str:
        """File name without suffix."""
        gait = f"{self.previous_gait}_to_{self.gait}" if self.previous_gait else self.gait
        rate = f"_{self.frequency_hz:g}hz" if self.frequency_hz else ""
        kind = f"perturbed_{self.seed:05d}" if self.from_standing else self.variant or describe_command(self.command)
        return f"{gait}{rate}_{kind}"

    @property
    def holds_command(self) -> bool:
        """Whether the clip is one command throughout, undisturbed, so that its means can be judged."""
        return not (self.from_standing or self.course or self.pushes or self.previous_gait)

    def command_at(self, time: float) -> np.ndarray:
        """The twist (3,) asked for at `time` s of the recording; before it, the first one."""
        if not self.course:
            return np.array(self.command)
        times, twists = zip(*self.course, strict=True)
        return np.array([np.interp(time, times, values) for values in zip(*twists, strict=True)])


def describe_command(command: Twist) -> str:
    """Words for a twist, such as 'forward_0.6', 'forward_0.5_turn_left_0.4' or 'in_place'."""
    words = (("forward", "backward"), ("left", "right"), ("turn_left", "turn_right"))
    parts = [f"{pair[value < 0]}_{abs(value):g}" for pair, value in zip(words, command, strict=True) if value]
    return "_".join(parts) or "in_place"


def shipped_requests(robot: Robot) -> list[ClipRequest]:
    """A robot's clips in the package."""
    requests = []
    for gait, frequency in _CELLS:
        requests += [*_steady(gait, frequency), *_varied(gait, frequency), *_recovery(robot, gait, frequency)]
    return [*requests, *_transitions(), *_standing(robot)]


def bearable(gait: str, frequency_hz: float, command: Twist) -> Twist:
    """The command, slowed down where the gait does not bear it."""
    vx, vy, wz = command
    return min(vx, GAITS[gait].fastest.get(frequency_hz, vx)), vy, wz


def _steady(gait: str, frequency: float) -> list[ClipRequest]:
    commands = dict.fromkeys(bearable(gait, frequency, command) for command in _STEADY)
    return [ClipRequest(gait, frequency, command) for command in commands]


def _varied(gait: str, frequency: float) -> list[ClipRequest]:
    """Speeding up, slowing down into reverse, two random sequences of commands, and two body heights."""
    fast, _, _ = bearable(gait, frequency, (1.0, 0.0, 0.0))
    backward, straight, medium = (-0.3, 0.0, 0.0), (fast, 0.0, 0.0), (0.4, 0.0, 0.0)
    courses = {
        "speeding_up": ((0.0, (0.0, 0.0, 0.0)), (3.0, straight), (4.0, straight)),
        "slowing_down": ((0.0, straight), (0.4, straight), (3.6, backward), (4.0, backward)),
    }
    requests = [
        ClipRequest(gait, frequency, course[0][1], split="varied", variant=variant, course=course)
        for variant, course in courses.items()
    ]
    for seed in range(2):
        twists = [random_command(_generator(gait, frequency, seed, draw)) for draw in range(3)]
        twists = [bearable(gait, frequency, twist) for twist in twists]
        held = (twists[0], twists[0], twists[1], twists[1], twists[2])
        course = tuple(zip(_CHANGES, held, strict=True))
        variant = f"changing_{seed:05d}"
        requests.append(
            ClipRequest(gait, frequency, twists[0], seed=seed, split="varied", variant=variant, course=course)
        )
    for word, height in (("low", -LOWER), ("high", HIGHER)):
        variant = f"{word}_{describe_command(medium)}"
        requests.append(ClipRequest(gait, frequency, medium, split="varied", variant=variant, height=height))
    return requests


def _recovery(robot: Robot, gait: str, frequency: float) -> list[ClipRequest]:
    """Two pushes each: one clip in place, one on the way."""
    requests = []
    for seed, command in enumerate(((0.0, 0.0, 0.0), (0.4, 0.0, 0.0))):
        pushes = _random_pushes(robot, _generator(gait, frequency, seed))
        variant = f"pushed_{seed:05d}"
        requests.append(
            ClipRequest(gait, frequency, command, seed=seed, split="recovery", variant=variant, pushes=pushes)
        )
    return requests


def _transitions() -> list[ClipRequest]:
    """Every gait into every other one at each frequency."""
    command = (0.3, 0.0, 0.0)
    return [
        ClipRequest(after, frequency, command, split="transition", previous_gait=before)
        for before in GAITS
        for after in GAITS
        for frequency in SHIPPED_FREQUENCIES[:2]
        if before != after and all(frequency in GAITS[gait].duty for gait in (before, after))
    ]


def _standing(robot: Robot) -> list[ClipRequest]:
    """Three body heights, undisturbed and pushed."""
    requests = []
    for seed, (word, height) in enumerate((("low", -0.05), ("medium", 0.0), ("high", 0.03))):
        stand = ClipRequest(STAND, 0.0, (0.0, 0.0, 0.0), seed=seed, split=STAND, variant=word, height=height)
        pushes = _random_pushes(robot, np.random.default_rng(seed))
        pushed = ClipRequest(
            STAND, 0.0, (0.0, 0.0, 0.0), seed=seed, split=STAND, variant=f"{word}_pushed", pushes=pushes, height=height
        )
        requests += [stand, pushed]
    return requests


def _random_pushes(robot: Robot, rng: np.random.Generator) -> tuple[Push, ...]:
    """Two pushes in random directions, leaving the first half second alone, which the validator replays."""
    pushes = []
    for time in (0.8, 2.4):
        size = rng.uniform(*_PUSH_SPEED) * robot.mass / PUSH_DURATION
        direction = rng.uniform(-np.pi, np.pi)
        start = round(time + rng.uniform(0.0, 0.4), 2)
        force = (round(float(size * np.cos(direction)), 1), round(float(size * np.sin(direction)), 1))
        pushes.append(Push(start, force))
    return tuple(pushes)


def _generator(gait: str, frequency_hz: float, *more: int) -> np.random.Generator:
    return np.random.default_rng((list(GAITS).index(gait), int(frequency_hz), *more))


def random_command(rng: np.random.Generator) -> Twist:
    """A twist from the ranges of the policy's commands, often without sideways speed or turning."""
    command = rng.uniform(_RANDOM_LOW, _RANDOM_HIGH)
    command[1:][rng.random(2) < _STRAIGHT_FRACTION] = 0.0
    if rng.random() < _IN_PLACE_FRACTION:
        command[:] = 0.0
    vx, vy, wz = (round(float(value), 3) for value in command)
    return vx, vy, wz


def perturbed_requests(count: int, seed: int, cells: Sequence[tuple[str, float]] = tuple(_CELLS)) -> list[ClipRequest]:
    """`count` clips with noisy targets from standing, the cells (gait, stride frequency in Hz) in turn.

    Commands are random; in every other clip of a cell another one follows on the way.
    """
    requests = []
    for index in range(count):
        rng = np.random.default_rng((seed, index))
        command = random_command(rng)
        noise = float(rng.choice(NOISE_LEVELS))
        course = ()
        if index // len(cells) % 2:
            change = round(float(rng.uniform(1.5, 2.5)), 2)
            course = ((0.0, command), (change, command), (change + 0.02, random_command(rng)))
        gait, frequency = cells[index % len(cells)]
        number = seed * 100_000 + index
        requests.append(
            ClipRequest(gait, frequency, command, number, noise, from_standing=True, split="perturbed", course=course)
        )
    return requests
