"""Schema of conf/motion: the clips and the skills."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from omegaconf import MISSING

from camp.common import checks
from camp.common.bounds import Within
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import FREQUENCY_RANGE_HZ, LABELS, Skill, skill_set

StrideFrequency = Annotated[float, Within(*FREQUENCY_RANGE_HZ, "Hz; where the gait metric counts strides")]
Transitions = Annotated[int, Within(1, 10**8, "more than all clips of any data set hold")]
Clips = Annotated[int, Within(1, 100_000, "weeks of generating")]


@dataclass
class MotionConfig:
    """conf/motion: the expert clips and the skills they teach."""

    folder: str | None = MISSING  # None: the clips shipped with the package
    skills: list[str] = MISSING  # gaits
    labels: str = MISSING  # gait: a skill is a gait; gait_frequency: a gait at one stride frequency
    frequencies_hz: list[StrideFrequency] = MISSING  # of the clips that are used, within skills.FREQUENCY_TOLERANCE
    mirrored: bool = MISSING  # also the left-right mirror images, perturbed clips' without their start
    num_preloaded: Transitions = MISSING  # transitions
    perturbed_folder: str | None = MISSING  # None: one below <output_dir>/motions
    perturbed_clips: Clips = MISSING  # for imitation

    def skill_set(self) -> tuple[Skill, ...]:
        """The skills in label order."""
        return skill_set(self.skills, self.labels, self.frequencies_hz)

    def check(self) -> None:
        checks.place("motion.folder", self.folder)
        checks.place("motion.perturbed_folder", self.perturbed_folder)
        skills = list(self.skills)
        unknown = [skill for skill in skills if skill not in GAIT_PHASES]
        remedy = f"choose from {', '.join(GAIT_PHASES)}"
        checks.require(len(skills) > 0, "motion.skills", skills, remedy)
        checks.require(not unknown, "motion.skills", skills, f"unknown gait {', '.join(unknown)}; {remedy}")
        checks.require(len(set(skills)) == len(skills), "motion.skills", skills, "name each gait once")
        checks.require(self.labels in LABELS, "motion.labels", self.labels, f"choose one of {', '.join(LABELS)}")
        frequencies = list(self.frequencies_hz)
        distinct = len(frequencies) > 0 and len(set(frequencies)) == len(frequencies)
        checks.require(distinct, "motion.frequencies_hz", frequencies, "list stride frequencies, each once")
