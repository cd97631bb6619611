"""The contract of a policy: how to speak to a network that somebody else trained. docs/judge.md specifies the file."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Literal

from pydantic import ConfigDict, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from camp.common.errors import CampError
from camp.common.foreign import first_problem, foreign_file, read_json
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import Skill
from camp.robots.quadruped import JOINT_NAMES, NUM_JOINTS
from camp.robots.registry import ROBOTS

STRICT = ConfigDict(extra="forbid")
# Numbers of each observation term, besides `skill`, which has as many as the encodings of `skills`.
TERM_SIZES = {
    "base_angular_velocity": 3,
    "base_linear_velocity": 3,
    "gravity": 3,
    "command": 3,
    "joint_position": NUM_JOINTS,
    "joint_velocity": NUM_JOINTS,
    "last_action": NUM_JOINTS,
    "phase": 2,
    "time": 1,
}
Numbers = float | list[float]


@dataclass(frozen=True, config=STRICT)
class Term:
    """One entry of the observation: clip((value - offset) * scale)."""

    term: str
    scale: Numbers = 1.0
    offset: Numbers = 0.0
    clip: tuple[float, float] | None = None


@dataclass(frozen=True, config=STRICT)
class Output:
    """What the network's answer means: joint target in rad = offset + scale * clip(answer)."""

    scale: Numbers = 1.0
    offset: Numbers = 0.0
    clip: tuple[float, float] | None = None


@dataclass(frozen=True, config=STRICT)
class CommandRange:
    """Commands that the policy was trained for, each [low, high]."""

    vx_m_s: tuple[float, float]
    vy_m_s: tuple[float, float]
    yaw_rate_rad_s: tuple[float, float]


@dataclass(frozen=True, config=STRICT)
class Contract:
    """Joints in the order of ``joint_names``; SI units."""

    contract: Literal[1]
    name: str
    robot: str  # whose model it walks on, of camp.robots.registry
    control_period_s: float
    joint_names: list[str]
    default_pose: list[float]  # rad; `joint_position` is told from it
    kp: list[float]  # N m/rad
    kd: list[float]  # N m s/rad
    output: Output
    observation: list[Term]
    skills: dict[str, list[float]]  # encoding of each skill, which the term `skill` shows
    command_range: CommandRange
    history: int = 1  # frames of the observation that the network sees
    history_order: Literal["oldest_first", "newest_first"] = "oldest_first"
    history_layout: Literal["frames", "terms"] = "frames"  # frame after frame, or each term's frames side by side

    def __post_init__(self) -> None:
        for problem in _problems(self):
            raise ValueError(problem)

    @property
    def skill_set(self) -> tuple[Skill, ...]:
        """The skills in the file's order."""
        return tuple(parse_skill(name) for name in self.skills)

    def size(self, term: Term) -> int:
        """Numbers of one frame of a term."""
        return len(next(iter(self.skills.values()))) if term.term == "skill" else TERM_SIZES[term.term]

    @property
    def observation_size(self) -> int:
        """Numbers that the network sees."""
        return self.history * sum(self.size(term) for term in self.observation)


def contract_on(contract: Contract, robot: str) -> Contract:
    """The contract of the same network, with the same gains and pose, on another robot."""
    name = contract.name if robot == contract.robot else f"{contract.name}_on_{robot}"
    return replace(contract, robot=robot, name=name)


def parse_skill(name: str) -> Skill:
    """A skill by its name, such as trot or trot_3hz. Raises ValueError."""
    found = re.fullmatch(r"(?P<gait>.+?)(?:_(?P<hz>\d+(?:\.\d+)?)hz)?", name)
    if found is None or found["gait"] not in GAIT_PHASES:
        known = ", ".join(GAIT_PHASES)
        raise ValueError(f"skill {name!r} is none of the judge's: name a gait ({known}), with or without _<n>hz")
    hz = None if found["hz"] is None else float(found["hz"])
    if hz == 0.0:
        raise ValueError(f"skill {name!r}: write a frequency above 0, as in trot_3hz")
    return Skill(found["gait"], hz)


def read_contract(path: Path) -> Contract:
    """Read and check a contract file. Raises CampError in one line."""
    remedy = "see docs/judge.md for what to write"
    with foreign_file(path, f"contract {path}: cannot be read", remedy, CampError):
        text = path.read_bytes()
    try:
        contract = TypeAdapter(Contract).validate_json(text)
    except ValidationError as error:
        raise CampError(f"contract {path}: {first_problem(error)}; docs/judge.md lists the keys") from error
    with foreign_file(path, f"contract {path}: cannot be used", remedy, CampError):
        read_json(text)  # whose numbers are finite
    return contract


def _problems(contract: Contract):
    """What types alone do not tell."""
    if contract.robot not in ROBOTS:
        yield f"robot = {contract.robot!r}: choose one of {', '.join(ROBOTS)}"
    if sorted(contract.joint_names) != sorted(JOINT_NAMES):
        yield f"joint_names: give the robot's 12 joints, such as {JOINT_NAMES[0]}, in the policy's order"
    for key in ("default_pose", "kp", "kd"):
        values = getattr(contract, key)
        if len(values) != NUM_JOINTS or not all(map(math.isfinite, values)):
            yield f"{key}: give {NUM_JOINTS} finite numbers, one per joint"
    if min(contract.kp) < 0 or min(contract.kd) < 0:
        yield "kp, kd: give gains of 0 or more"
    if not 0.005 <= contract.control_period_s <= 0.1:
        yield f"control_period_s = {contract.control_period_s:g}: choose 0.005 to 0.1 s, a multiple of 0.005 s"
    if abs(contract.control_period_s / 0.005 - round(contract.control_period_s / 0.005)) > 1e-6:
        yield f"control_period_s = {contract.control_period_s:g}: choose a multiple of the physics step, 0.005 s"
    if not contract.skills or not contract.observation:
        yield "skills, observation: give one entry or more"
    if len({len(encoding) for encoding in contract.skills.values()}) > 1:
        yield "skills: give encodings of one length"
    if contract.history < 1:
        yield f"history = {contract.history}: give 1 or more frames"
    for name in contract.skills:
        try:
            parse_skill(name)
        except ValueError as error:
            yield str(error)
    for term in contract.observation:
        if term.term not in (*TERM_SIZES, "skill"):
            yield f"observation: term {term.term!r} is unknown; choose from {', '.join((*TERM_SIZES, 'skill'))}"
        elif term.term == "phase" and any(parse_skill(name).frequency_hz is None for name in contract.skills):
            yield "observation: the term phase needs skills with a frequency, such as trot_3hz"
        else:
            for key in ("scale", "offset"):
                if problem := _misfit(getattr(term, key), contract.size(term)):
                    yield f"observation: {key} of {term.term} {problem}"
    for key in ("scale", "offset"):
        if problem := _misfit(getattr(contract.output, key), NUM_JOINTS):
            yield f"output: {key} {problem}"


def _misfit(value: Numbers, size: int) -> str | None:
    values = value if isinstance(value, list) else [value]
    if not all(map(math.isfinite, values)):
        return "holds values that are not finite"
    return f"has {len(values)} numbers: give one, or {size}" if isinstance(value, list) and len(value) != size else None
